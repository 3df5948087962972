//! The days of a fleet, one after the other. Nothing here looks at a later day.

use crate::Alarm;
use crate::alarm::Raised;
use crate::clean::{Clean, Day, clean};
use crate::discoveries::{Weights, rejected};
use crate::meanwhile::{Meanwhile, meanwhile};
use crate::member::{Group, Member};
use crate::siblings::{Levels, ln_e_value};
use crate::{Series, Settings};
use std::collections::BTreeMap;

/// Fewest days a calibration can do with.
const LEAST_DAYS: usize = 6;
/// Part of the days of the calibration on which a covariate must be known to be one.
const KNOWN: f64 = 0.75;

/// Table, parameter, and which covariates are known.
type GroupKey<'a> = (&'a str, &'a str, [bool; 2]);
/// The same, kept.
type OwnedKey = (String, String, [bool; 2]);

/// A series and what has become of it.
pub(crate) struct Entry<'a> {
    pub(crate) clean: Clean<'a>,
    /// Days up to the present one.
    seen: usize,
    ln_weight: Option<f64>,
    /// Once it has enough days.
    known: Option<[bool; 2]>,
    pub(crate) member: Option<Member>,
    pub(crate) alarmed: bool,
}

impl<'a> Entry<'a> {
    pub(crate) fn key(&self) -> Option<GroupKey<'_>> {
        let (table, parameter) = self.clean.family();
        Some((table, parameter, self.known?))
    }

    fn is_watched(&self) -> bool {
        self.member.is_some() && !self.alarmed
    }
}

/// The fleet as it is known at the end of a day.
pub(crate) struct Fleet<'a> {
    settings: Settings,
    pub(crate) entries: Vec<Entry<'a>>,
    pub(crate) groups: BTreeMap<OwnedKey, Group>,
    weights: Weights,
    has_begun: bool,
    pub(crate) alarms: Vec<Alarm>,
}

impl<'a> Fleet<'a> {
    pub(crate) fn new(series: &'a [Series], settings: &Settings) -> Self {
        let entry =
            |clean| Entry { clean, seen: 0, ln_weight: None, known: None, member: None, alarmed: false };
        Self {
            settings: sane(settings),
            entries: clean(series).into_iter().map(entry).collect(),
            groups: BTreeMap::new(),
            weights: Weights::default(),
            has_begun: false,
            alarms: Vec::new(),
        }
    }

    /// All days.
    pub(crate) fn run(&mut self) {
        let mut days: BTreeMap<i64, Vec<(usize, usize)>> = BTreeMap::new();
        for (e, entry) in self.entries.iter().enumerate() {
            for (k, day) in entry.clean.days.iter().enumerate() {
                days.entry(day.day).or_default().push((e, k));
            }
        }
        for (day, present) in days {
            self.observe(day, &present);
            self.calibrate();
            self.hand_out_weights();
            self.decide(day);
        }
    }

    /// The day's effects of the groups, then the day itself.
    fn observe(&mut self, day: i64, present: &[(usize, usize)]) {
        let mut surprises: BTreeMap<OwnedKey, Vec<f64>> = BTreeMap::new();
        for &(e, k) in present {
            let entry = &self.entries[e];
            let Some((key, group)) = self.group_of(entry) else { continue };
            if let (true, Some(member)) = (entry.is_watched(), &entry.member) {
                surprises.entry(key).or_default().push(member.surprise(&entry.clean.days[k], group));
            }
        }
        for (key, surprises) in surprises {
            if let (true, Some(group)) =
                (surprises.len() >= self.settings.least_siblings, self.groups.get_mut(&key))
            {
                let common = crate::robust::median(&surprises).unwrap_or(0.0);
                group.effects.insert(day, (common, surprises.len()));
            }
        }
        for &(e, k) in present {
            let entry = &mut self.entries[e];
            entry.seen = k + 1;
            let Some(known) = entry.known else { continue };
            let key = owned((&entry.clean.source.table, &entry.clean.source.parameter, known));
            let Some(group) = self.groups.get(&key) else { continue };
            if let (false, Some(member)) = (entry.alarmed, &mut entry.member) {
                let reading = member.reading(&entry.clean.days[k], group);
                member.evidence.observe(&reading);
            }
        }
    }

    pub(crate) fn group_of(&self, entry: &Entry<'_>) -> Option<(OwnedKey, &Group)> {
        let key = owned(entry.key()?);
        let group = self.groups.get(&key)?;
        Some((key, group))
    }

    /// Calibrates groups of which half of the robots have enough days, and their robots that have.
    fn calibrate(&mut self) {
        let needed = self.settings.calibration_days;
        let waiting = |e: &Entry<'_>| e.member.is_none() && e.seen >= needed;
        if !self.entries.iter().any(waiting) {
            return;
        }
        let mut ready: BTreeMap<(String, String), (usize, usize)> = BTreeMap::new();
        for entry in self.entries.iter_mut().filter(|e| e.seen > 0) {
            let (table, parameter) = entry.clean.family();
            let counts = ready.entry((table.to_owned(), parameter.to_owned())).or_default();
            counts.0 += usize::from(entry.seen >= needed);
            counts.1 += 1;
            if entry.seen >= needed && entry.known.is_none() {
                entry.known = Some(known(&entry.clean.days[..needed]));
            }
        }
        let mut new: BTreeMap<OwnedKey, Vec<usize>> = BTreeMap::new();
        for (e, entry) in self.entries.iter().enumerate().filter(|(_, e)| waiting(e)) {
            let Some(key) = entry.key().map(owned) else { continue };
            let (enough, all) = ready.get(&(key.0.clone(), key.1.clone())).copied().unwrap_or_default();
            if self.groups.contains_key(&key) || 2 * enough >= all {
                new.entry(key).or_default().push(e);
            }
        }
        new.into_iter().for_each(|(key, members)| self.begin(key, &members));
    }

    /// Begins to watch these series of one group.
    fn begin(&mut self, key: OwnedKey, new: &[usize]) {
        let least = self.settings.least_siblings;
        let days: Vec<&[Day]> =
            new.iter().map(|&e| &self.entries[e].clean.days[..self.entries[e].seen]).collect();
        let group = self.groups.entry(key.clone()).or_insert_with(|| Group::calibrate(&days, key.2, least));
        let members: Vec<Member> =
            days.iter().map(|d| Member::calibrate(d, group, self.settings.outlier_days)).collect();
        new.iter().zip(members).for_each(|(&e, member)| self.entries[e].member = Some(member));
        self.compare(&key, new);
    }

    /// Levels of new members against those of all siblings.
    fn compare(&mut self, key: &OwnedKey, new: &[usize]) {
        let same = |e: &Entry<'_>| e.key().map(owned).as_ref() == Some(key);
        let group: Vec<(usize, f64)> = self
            .entries
            .iter()
            .enumerate()
            .filter(|(_, e)| same(e))
            .filter_map(|(k, e)| Some((k, e.member.as_ref()?.level.mean)))
            .collect();
        let levels = Levels::new(group.iter().map(|g| g.1).collect());
        for (place, &(e, own)) in group.iter().enumerate() {
            let Some(member) = self.entries[e].member.as_mut().filter(|_| new.contains(&e)) else { continue };
            if group.len() > self.settings.least_siblings {
                let compared = levels.compare(place, own, member.level.sigma);
                member.evidence.ln_siblings = compared.map_or(0.0, |c| ln_e_value(&c));
            }
        }
    }

    /// Weights of series that have come; those that are there when the first one is watched are founders.
    fn hand_out_weights(&mut self) {
        self.has_begun |= self.entries.iter().any(|e| e.member.is_some());
        let new = |e: &&mut Entry<'_>| e.seen > 0 && e.ln_weight.is_none();
        let count = self.entries.iter_mut().filter(new).count();
        if self.has_begun && count > 0 {
            let weight = self.weights.next(count);
            self.entries.iter_mut().filter(new).for_each(|e| e.ln_weight = Some(weight));
        }
    }

    /// Raises the day's alarms.
    fn decide(&mut self, day: i64) {
        let weighted: Vec<f64> = self
            .entries
            .iter()
            .map(|e| match (&e.member, e.ln_weight) {
                (Some(member), Some(weight)) => weight + member.evidence.ln_e_value(),
                _ => f64::NEG_INFINITY,
            })
            .collect();
        let (_, least) = rejected(&weighted, self.settings.false_discoveries);
        let mut raised: Vec<Alarm> = Vec::new();
        for e in 0..self.entries.len() {
            if self.entries[e].alarmed || weighted[e] < least {
                continue;
            }
            let Some(alarm) = self.alarm(e, day) else { continue };
            self.entries[e].alarmed = true;
            raised.push(alarm);
        }
        raised.sort_by(|a, b| b.e_value.total_cmp(&a.e_value));
        self.alarms.append(&mut raised);
    }

    fn alarm(&self, e: usize, day: i64) -> Option<Alarm> {
        let entry = &self.entries[e];
        let member = entry.member.as_ref()?;
        let ln_e_value = member.evidence.ln_e_value();
        let raised = Raised { source: entry.clean.source, day, ln_e_value };
        Some(match member.evidence.began() {
            Some(began) => raised.change(&began, member.sizes(&began), self.meanwhile(e, began.start)),
            None => {
                let levels = self.levels_of_siblings(e)?;
                let centre = crate::robust::median(&levels)?;
                raised.unlike_siblings(entry.clean.days.first()?.day, member.level, (levels.len(), centre))
            }
        })
    }

    /// What robots with the same table did up to now while a series changed.
    fn meanwhile(&self, e: usize, began: i64) -> Meanwhile {
        let family = self.entries[e].clean.family();
        let same = |(k, other): &(usize, &Entry<'_>)| *k != e && other.clean.family() == family;
        let siblings = self.entries.iter().enumerate().filter(same);
        meanwhile(siblings.map(|(_, sibling)| &sibling.clean.days[..sibling.seen]), began)
    }

    /// Levels of a series' siblings.
    fn levels_of_siblings(&self, e: usize) -> Option<Vec<f64>> {
        let key = self.entries[e].key()?;
        let same = self.entries.iter().enumerate().filter(|(k, other)| *k != e && other.key() == Some(key));
        Some(same.filter_map(|(_, s)| Some(s.member.as_ref()?.level.mean)).collect())
    }
}

fn owned(key: GroupKey<'_>) -> OwnedKey {
    (key.0.to_owned(), key.1.to_owned(), key.2)
}

/// Which covariates these days know.
fn known(days: &[Day]) -> [bool; 2] {
    [0, 1].map(|k| {
        days.iter().filter(|d| d.covariates[k].is_some()).count() as f64 >= KNOWN * days.len() as f64
    })
}

/// Settings within what can be reckoned with.
fn sane(settings: &Settings) -> Settings {
    let default = Settings::default();
    let inside =
        |x: f64, low: f64, high: f64, default: f64| if x.is_nan() { default } else { x.clamp(low, high) };
    Settings {
        false_discoveries: inside(settings.false_discoveries, 1e-12, 1.0 - 1e-12, default.false_discoveries),
        calibration_days: settings.calibration_days.max(LEAST_DAYS),
        outlier_days: inside(settings.outlier_days, 1e-6, 0.5, default.outlier_days),
        least_siblings: settings.least_siblings.max(3),
    }
}
