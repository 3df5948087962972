//! Numbers of a message of any type, by its definition.

use super::cdr::{Cdr, Fault};
use super::definition::{Definition, Field, Many, Number, Type};
use super::path::{Element, Path};

/// Lists of names that are taken where none is named.
const NAMES: [&str; 3] = ["joint_names", "name", "names"];
/// Most bytes that a message without fields has: one that holds its place.
const PLACE_HOLDER: usize = 1;

/// What is done with a field.
enum Action {
    PassOver,
    /// A number of a column.
    Number(Vec<usize>),
    /// A list of numbers, some of which are wanted.
    List(usize),
    /// Fields within.
    Inside(Vec<Action>),
    /// Fields within some of a list of messages.
    Some(Vec<(usize, Vec<Action>)>),
    /// The time of the message.
    Stamp,
    /// The names of a list's elements.
    Names,
}

/// Which elements of a list are wanted, and its numbers in the message that is read.
struct List {
    wanted: Vec<(Element, usize)>,
    values: Vec<f64>,
}

/// Reads the wanted numbers of messages of one definition.
pub(super) struct Plan {
    definition: Definition,
    actions: Vec<Action>,
    lists: Vec<List>,
    /// Names in the message that is read, and whether any list needs them.
    names: Vec<String>,
    count: usize,
    stamp: i64,
}

impl Plan {
    /// From paths with the columns that they are wanted for; `names` is the path of the list of names.
    ///
    /// # Errors
    /// A path that leads to no number, told by its column's name.
    pub fn new(
        definition: Definition,
        wanted: &[(String, Path, usize)],
        names: Option<&str>,
    ) -> Result<Self, String> {
        let mut plan = Self {
            definition,
            actions: Vec::new(),
            lists: Vec::new(),
            names: Vec::new(),
            count: 0,
            stamp: 0,
        };
        let mut actions = plan.nothing_of(0);
        for (column, path, slot) in wanted {
            plan.want(&mut actions, path, *slot).map_err(|why| {
                format!("`{column}`: {why}; its numbers are {}", plan.definition.numbers().join(", "))
            })?;
        }
        plan.want_stamp(&mut actions);
        plan.want_names(&mut actions, wanted, names)?;
        plan.actions = actions;
        Ok(plan)
    }

    fn nothing_of(&self, message: usize) -> Vec<Action> {
        self.definition.messages[message].iter().map(|_| Action::PassOver).collect()
    }

    /// Adds a number to what is read.
    fn want(&mut self, actions: &mut Vec<Action>, path: &Path, slot: usize) -> Result<(), String> {
        let field = self.definition.field(path)?.clone();
        let last = path.steps.last().map_or("", |(name, _)| name.as_str());
        match (field.kind, field.many, &path.element) {
            (Type::Number(_), Many::One, None) => {
                if let Action::Number(slots) = self.at(actions, path, || Action::Number(Vec::new()))? {
                    slots.push(slot);
                }
                Ok(())
            }
            (Type::Number(_), Many::One, Some(_)) => Err(format!("`{last}` is one number and no list")),
            (Type::Number(_), _, Some(element)) => {
                let next = self.lists.len();
                let Action::List(list) = *self.at(actions, path, || Action::List(next))? else {
                    return Err(format!("`{last}` is wanted in two ways"));
                };
                if list == next {
                    self.lists.push(List { wanted: Vec::new(), values: Vec::new() });
                }
                self.lists[list].wanted.push((element.clone(), slot));
                Ok(())
            }
            (Type::Number(_), _, None) => {
                Err(format!("`{last}` is a list: `{last}[0]`, or `{last}[name]` by the list of names"))
            }
            _ => Err(format!("`{last}` is no number")),
        }
    }

    /// The action at a path, made where there is none yet.
    fn at<'a>(
        &self,
        actions: &'a mut Vec<Action>,
        path: &Path,
        make: impl Fn() -> Action,
    ) -> Result<&'a mut Action, String> {
        let (mut actions, mut message) = (actions, 0);
        let count = path.steps.len();
        for (depth, (name, place)) in path.steps.iter().enumerate() {
            let fields = &self.definition.messages[message];
            let k = fields.iter().position(|field| field.name == *name).ok_or("there is no such field")?;
            let action = &mut actions[k];
            if depth + 1 == count {
                if matches!(action, Action::PassOver) {
                    *action = make();
                }
                return Ok(action);
            }
            let Type::Message(inner) = fields[k].kind else { return Err(format!("`{name}` has no fields")) };
            actions = match (fields[k].many, place) {
                (Many::One, None) => {
                    if matches!(action, Action::PassOver) {
                        *action = Action::Inside(self.nothing_of(inner));
                    }
                    let Action::Inside(within) = action else {
                        return Err(format!("`{name}` is read already"));
                    };
                    within
                }
                (Many::One, Some(_)) => return Err(format!("`{name}` is no list")),
                (_, None) => return Err(format!("`{name}` is a list: `{name}[0]`")),
                (_, Some(place)) => {
                    if matches!(action, Action::PassOver) {
                        *action = Action::Some(Vec::new());
                    }
                    let Action::Some(some) = action else { return Err(format!("`{name}` is read already")) };
                    let at = some.iter().position(|(known, _)| known == place).unwrap_or(some.len());
                    if at == some.len() {
                        some.push((*place, self.nothing_of(inner)));
                    }
                    &mut some[at].1
                }
            };
            message = inner;
        }
        Err("it is empty".into())
    }

    /// The time of the message: `header.stamp`, else `stamp`, where it is one.
    fn want_stamp(&self, actions: &mut Vec<Action>) {
        for name in ["header.stamp", "stamp"] {
            let Some(path) = Path::parse(name) else { continue };
            let Ok(Field { kind: Type::Message(inner), many: Many::One, .. }) = self.definition.field(&path)
            else {
                continue;
            };
            let kinds: Vec<Type> = self.definition.messages[*inner].iter().map(|field| field.kind).collect();
            let is_time = kinds == [Type::Number(Number::I32), Type::Number(Number::U32)];
            // Where a part of the time is wanted as a number, it is none of the message.
            if is_time && self.at(actions, &path, || Action::Stamp).is_ok() {
                return;
            }
        }
    }

    fn want_names(
        &self,
        actions: &mut Vec<Action>,
        wanted: &[(String, Path, usize)],
        names: Option<&str>,
    ) -> Result<(), String> {
        let by_name = |path: &Path| matches!(path.element, Some(Element::Name(_)));
        if !wanted.iter().any(|(_, path, _)| by_name(path)) {
            return Ok(());
        }
        let is_list = |path: &Path| {
            let field = self.definition.field(path);
            field.is_ok_and(|field| field.kind == Type::Text && field.many != Many::One)
        };
        let found = match names {
            Some(name) => Path::parse(name).filter(|path| is_list(path)),
            None => NAMES.into_iter().filter_map(Path::parse).find(is_list),
        };
        let Some(path) = found else {
            let what = names.map_or_else(|| NAMES.join(", "), str::to_owned);
            return Err(format!(
                "elements are asked for by their names, but there is no list of names ({what}): `fields: {{names: ...}}`, \
                 or count from 0"
            ));
        };
        self.at(actions, &path, || Action::Names).map(|_| ())
    }

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
    let names = NAMES.into_iter().rev().filter_map(|name| {
        let path = Path::parse(name)?;
        let field = definition.field(&path).ok()?;
        (field.kind == Type::Text && field.many != Many::One).then_some(name)
    });
    let names = names.last();
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
