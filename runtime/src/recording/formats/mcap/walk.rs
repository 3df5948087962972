//! Messages of any type, read by a plan of their fields.

use super::cdr::{Cdr, Fault};
use super::definition::{Definition, Field, Many, Type};
use super::path::{Element, Path};
use super::plan::{Action, NAMES, Plan};

/// Bytes of a message without fields: one that holds its place.
const PLACE_HOLDER: usize = 1;

impl Plan {
    /// The stamp of a message, ns, 0 where it has none; the numbers are handed to `take` as column and value.
    pub fn read(&mut self, data: &[u8], take: &mut impl FnMut(usize, f64)) -> Result<i64, Fault> {
        let mut cdr = Cdr::new(data)?;
        self.stamp = 0;
        self.count = 0;
        self.lists.iter_mut().for_each(|list| list.values.clear());
        let actions = std::mem::take(&mut self.actions);
        let read = self.message(&mut cdr, 0, Some(&actions), take);
        self.actions = actions;
        read?;
        let names = &self.names[..self.count];
        for list in &self.lists {
            for (element, slot) in &list.wanted {
                let place = match element {
                    Element::Place(place) => Some(*place),
                    Element::Name(name) => names.iter().position(|known| known == name),
                };
                let value = place.and_then(|place| list.values.get(place));
                if let Some(value) = value.filter(|value| value.is_finite()) {
                    take(*slot, *value);
                }
            }
        }
        Ok(self.stamp)
    }

    /// Names in the message that was read last.
    pub fn names(&self) -> &[String] {
        &self.names[..self.count]
    }

    fn message(
        &mut self,
        cdr: &mut Cdr<'_>,
        message: usize,
        actions: Option<&Vec<Action>>,
        take: &mut impl FnMut(usize, f64),
    ) -> Result<(), Fault> {
        let count = self.definition.messages[message].len();
        if count == 0 {
            cdr.take(PLACE_HOLDER)?;
        }
        for k in 0..count {
            let Field { kind, many, .. } = self.definition.messages[message][k];
            let action = actions.map_or(&Action::PassOver, |actions| &actions[k]);
            match many {
                Many::One => self.value(cdr, kind, action, take)?,
                Many::Fixed(length) => self.values(cdr, kind, length, action, take)?,
                Many::Sequence => {
                    let length = cdr.count(1)?;
                    self.values(cdr, kind, length, action, take)?;
                }
            }
        }
        Ok(())
    }

    fn value(
        &mut self,
        cdr: &mut Cdr<'_>,
        kind: Type,
        action: &Action,
        take: &mut impl FnMut(usize, f64),
    ) -> Result<(), Fault> {
        match (kind, action) {
            (Type::Message(_), Action::Stamp) => self.stamp = cdr.stamp()?,
            (Type::Message(inner), Action::Inside(within)) => self.message(cdr, inner, Some(within), take)?,
            (Type::Message(inner), _) => self.message(cdr, inner, None, take)?,
            (Type::Number(number), action) => {
                let value = cdr.number(number)?;
                if let (Action::Number(slots), true) = (action, value.is_finite()) {
                    slots.iter().for_each(|slot| take(*slot, value));
                }
            }
            (Type::Text, _) => drop(cdr.text()?),
            (Type::WideText, _) => return Err("it holds a text of wide characters"),
        }
        Ok(())
    }

    fn values(
        &mut self,
        cdr: &mut Cdr<'_>,
        kind: Type,
        length: usize,
        action: &Action,
        take: &mut impl FnMut(usize, f64),
    ) -> Result<(), Fault> {
        match (kind, action) {
            (Type::Number(number), Action::List(list)) => {
                cdr.numbers(number, length, |value| self.lists[*list].values.push(value))?;
            }
            (Type::Number(number), _) => cdr.pass_over(number, length)?,
            (Type::Text, Action::Names) => {
                for k in 0..length {
                    let name = cdr.text()?;
                    self.name(k, name);
                }
                self.count = length;
            }
            (Type::Message(inner), Action::Some(some)) => {
                for k in 0..length {
                    let within = some.iter().find(|(place, _)| *place == k).map(|(_, within)| within);
                    self.message(cdr, inner, within, take)?;
                }
            }
            _ => {
                for _ in 0..length {
                    self.value(cdr, kind, &Action::PassOver, take)?;
                }
            }
        }
        Ok(())
    }

    /// Keeps the name at a place; the names of the message before are usually the same.
    fn name(&mut self, place: usize, name: &[u8]) {
        let name = String::from_utf8_lossy(name);
        match self.names.get_mut(place) {
            Some(known) if *known == name => {}
            Some(known) => *known = name.into_owned(),
            None => self.names.push(name.into_owned()),
        }
    }
}

/// The numbers of a message by their paths, the elements of a list by the names in it where there are as many; and its stamp,
/// ns.
///
/// # Errors
/// A message that its definition does not fit.
pub(super) fn signals(
    definition: &Definition,
    data: &[u8],
    most: usize,
) -> Result<(Vec<String>, i64), Fault> {
    let stamp =
        Plan::new(definition.clone(), &[], None).map_or(Ok(0), |mut plan| plan.read(data, &mut |_, _| {}))?;
    let names = NAMES
        .into_iter()
        .find(|name| Path::parse(name).is_some_and(|path| definition.is_list_of_names(&path)));
    let mut all = Vec::new();
    for path in definition.numbers() {
        let Some(stem) = path.strip_suffix("[]") else {
            if !path.contains("stamp.") && !path.contains("time_from_start.") {
                all.push(path);
            }
            continue;
        };
        // A name that no list has, so that lists and names are read.
        let column = format!("{stem}[{}]", if names.is_some() { "?" } else { "0" });
        let Some(parsed) = Path::parse(&column) else { continue };
        let wanted = [(column, parsed, 0)];
        let Ok(mut plan) = Plan::new(definition.clone(), &wanted, names) else { continue };
        plan.read(data, &mut |_, _| {})?;
        let length = plan.lists.first().map_or(0, |list| list.values.len());
        if length == plan.names().len() {
            all.extend(plan.names().iter().map(|name| format!("{stem}[{name}]")));
        } else {
            all.extend((0..length.min(most)).map(|k| format!("{stem}[{k}]")));
        }
    }
    all.truncate(most);
    Ok((all, stamp))
}
