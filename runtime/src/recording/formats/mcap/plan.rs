//! What of messages of any type is read: a plan of their fields, by their definition.

use super::definition::{Definition, Field, Many, Number, Type};
use super::path::{Element, Path};

/// Lists of names that are taken where none is named.
pub(super) const NAMES: [&str; 3] = ["joint_names", "name", "names"];

/// What is done with a field.
pub(super) enum Action {
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
pub(super) struct List {
    pub wanted: Vec<(Element, usize)>,
    pub values: Vec<f64>,
}

/// Reads the wanted numbers of messages of one definition.
pub(super) struct Plan {
    pub definition: Definition,
    pub actions: Vec<Action>,
    pub lists: Vec<List>,
    /// Names in the message that is read: the first `count` of these.
    pub names: Vec<String>,
    pub count: usize,
    pub stamp: i64,
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
        let is_list = |path: &Path| self.definition.is_list_of_names(path);
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
}
