//! What a generated function does, in no language yet: a list of statements that each printer writes down.

/// An expression with its operators and signs as they are evaluated.
#[derive(Debug, Clone, PartialEq)]
pub enum Formula {
    /// A number.
    Constant(f64),
    /// A variable or input.
    Variable(String),
    /// Minus a value.
    Minus(Box<Formula>),
    /// -1, 0 or 1.
    Sign(Box<Formula>),
    /// 1 / sqrt, 0 where there is none.
    InverseRoot(Box<Formula>),
    /// A sum.
    Sum(Box<Formula>, Box<Formula>),
    /// A difference.
    Difference(Box<Formula>, Box<Formula>),
    /// A product.
    Product(Box<Formula>, Box<Formula>),
    /// total + a * b, or total - a * b: one fused operation where the machine has it.
    Accumulated {
        /// What is added to.
        total: Box<Formula>,
        /// a and b.
        factors: Box<[Formula; 2]>,
        /// Whether the product is taken off.
        subtracted: bool,
    },
}

/// How tightly the outermost operator of an expression binds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Binding {
    /// A sum or difference.
    Sum,
    /// A product.
    Product,
    /// A sign in front.
    Sign,
    /// A name, a number, a call.
    Atom,
}

impl Formula {
    /// How tightly it binds.
    pub fn binding(&self) -> Binding {
        match self {
            Formula::Sum(..) | Formula::Difference(..) => Binding::Sum,
            Formula::Product(..) => Binding::Product,
            Formula::Minus(_) => Binding::Sign,
            Formula::Constant(_)
            | Formula::Variable(_)
            | Formula::Sign(_)
            | Formula::InverseRoot(_)
            | Formula::Accumulated { .. } => Binding::Atom,
        }
    }
}

/// Sine and cosine of one angle.
#[derive(Debug, Clone, PartialEq)]
pub struct SineCosine {
    /// Variable of the sine, where it is used.
    pub sine: Option<String>,
    /// Variable of the cosine, where it is used.
    pub cosine: Option<String>,
    /// The angle, rad.
    pub angle: Formula,
}

/// One step of a function.
#[derive(Debug, Clone, PartialEq)]
pub enum Statement {
    /// The values of an input array that are used, by their place.
    Unpack {
        /// The array.
        array: String,
        /// Its values; `None` for one that is not used.
        values: Vec<Option<String>>,
    },
    /// Sines and cosines.
    SinesAndCosines(Vec<SineCosine>),
    /// A word to the reader.
    Comment(String),
    /// A variable gets its value.
    Let {
        /// Its name.
        name: String,
        /// Its value.
        value: Formula,
    },
    /// A result is written.
    Output {
        /// The array.
        result: String,
        /// Its index.
        index: usize,
        /// The value.
        value: Formula,
    },
}

impl Statement {
    /// The variables that it defines.
    pub fn defines(&self) -> Vec<String> {
        match self {
            Statement::Unpack { values, .. } => values.iter().flatten().cloned().collect(),
            Statement::SinesAndCosines(pairs) => {
                pairs.iter().flat_map(|p| [&p.sine, &p.cosine]).flatten().cloned().collect()
            }
            Statement::Let { name, .. } => vec![name.clone()],
            Statement::Comment(_) | Statement::Output { .. } => Vec::new(),
        }
    }
}
