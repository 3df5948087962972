//! C99.

use super::law::{FUNCTIONS, LawFormula};
use super::{CFiles, Export, Real, header};
use crate::emit::{Binding, Formula, Function, Signature, Statement, functions};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The header and the source of a robot.
pub fn files(export: &Export<'_>, real: Real) -> CFiles {
    let printer = Printer { export, real };
    let name = export.name.clone();
    CFiles { header: printer.header(), source: printer.source(), name }
}

struct Printer<'a> {
    export: &'a Export<'a>,
    real: Real,
}

impl Printer<'_> {
    /// The type of numbers.
    fn real(&self) -> &'static str {
        match self.real {
            Real::Single => "float",
            Real::Double => "double",
        }
    }

    /// What ends a literal and the name of a mathematical function.
    fn suffix(&self) -> &'static str {
        match self.real {
            Real::Single => "f",
            Real::Double => "",
        }
    }

    fn upper(&self) -> String {
        self.export.name.to_ascii_uppercase()
    }

    fn header(&self) -> String {
        let (name, upper, export) = (&self.export.name, self.upper(), self.export);
        let mut text = comment(&header::lines(export));
        let (rows, columns) = export.pattern();
        let sizes = [
            ("N", "Number of joints.", rows.len() - 1),
            ("NB", "Number of base parameters.", export.set.base.len()),
            ("ENTRIES", "Number of entries of IDM that are not identically zero.", columns.len()),
        ];
        let _ = writeln!(
            text,
            "#ifndef {upper}_H\n#define {upper}_H\n\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n"
        );
        for (size, what, value) in sizes {
            let _ = writeln!(text, "/* {what} */\n#define {upper}_{size} {value}");
        }
        let _ = writeln!(
            text,
            "\n/* Row i of IDM has the entries {name}_rows[i] to {name}_rows[i + 1] - 1; entry e is of base parameter \
             {name}_columns[e]. */\nextern const int {name}_rows[{upper}_N + 1];\nextern const int \
             {name}_columns[{upper}_ENTRIES];\n\n/* The names of the base parameters. */\nextern const char *const \
             {name}_names[{upper}_NB];\n"
        );
        for function in &self.functions() {
            let _ = writeln!(
                text,
                "/* {} */\n{};\n",
                function.signature.doc,
                self.prototype(&function.signature)
            );
        }
        if export.known.is_some() {
            let _ = writeln!(
                text,
                "/* The base parameters of the identified model. */\nextern const {} {name}_chi[{upper}_NB];\n\n/* Torques \
                 of the identified model, all that it leaves to its laws included. */\n{};\n",
                self.real(),
                self.known_prototype()
            );
        }
        let _ = writeln!(text, "#ifdef __cplusplus\n}}\n#endif\n\n#endif");
        text
    }

    fn source(&self) -> String {
        let (name, upper, export) = (&self.export.name, self.upper(), self.export);
        let (rows, columns) = export.pattern();
        let names: Vec<String> = export.set.base.iter().map(|p| format!("\"{}\"", p.name)).collect();
        let texts = |values: &[usize]| values.iter().map(ToString::to_string).collect::<Vec<_>>();
        let mut text = format!("/* {name}: see {name}.h. */\n#include \"{name}.h\"\n\n#include <math.h>\n\n");
        let functions = self.functions();
        text.push_str(&self.helpers(&functions));
        let mut array = |kind: &str, array: &str, length: &str, values: &[String]| {
            let _ = writeln!(text, "{kind} {name}_{array}[{length}] = {{\n{}}};\n", wrapped(values));
        };
        array("const int", "rows", &format!("{upper}_N + 1"), &texts(&rows));
        array("const int", "columns", &format!("{upper}_ENTRIES"), &texts(&columns));
        array("const char *const", "names", &format!("{upper}_NB"), &names);
        for function in &functions {
            self.function(&mut text, function);
        }
        if export.known.is_some() {
            let literals = |values: &[f64]| values.iter().map(|&x| self.literal(x)).collect::<Vec<_>>();
            let kind = format!("const {}", self.real());
            let mut array = |kind: &str, array: &str, values: &[f64]| {
                let _ = writeln!(
                    text,
                    "{kind} {name}_{array}[{upper}_NB] = {{\n{}}};\n",
                    wrapped(&literals(values))
                );
            };
            array(&kind, "chi", &export.parameters());
            if export.needs_loads() {
                array(&format!("static {kind}"), "chi_load", &export.load_parameters());
            }
            self.known_torques(&mut text);
        }
        text
    }

    fn functions(&self) -> Vec<Function> {
        functions(&self.export.table, &self.export.set, &self.export.equations, usize::MAX)
    }

    fn prototype(&self, signature: &Signature<'_>) -> String {
        let (real, upper) = (self.real(), self.upper());
        let length =
            |text: &str| text.split(" * ").map(|f| format!("{upper}_{f}")).collect::<Vec<_>>().join(" * ");
        let arguments =
            signature.arguments.iter().map(|(name, size)| format!("const {real} {name}[{}]", length(size)));
        let results = signature.results.iter().map(|(name, size)| {
            let size = size.unwrap_or(match *name {
                "idm" => "ENTRIES",
                "tau" => "N",
                _ => "NB",
            });
            format!("{real} {name}[{}]", length(size))
        });
        let all: Vec<String> = arguments.chain(results).collect();
        format!("void {}_{}({})", self.export.name, signature.name, all.join(", "))
    }

    fn known_prototype(&self) -> String {
        let (real, upper, name) = (self.real(), self.upper(), &self.export.name);
        let state = ["q", "dq", "ddq"].map(|x| format!("const {real} {x}[{upper}_N], ")).concat();
        format!("void {name}_model_tau({state}{real} tau[{upper}_N])")
    }

    /// The small functions that the others use.
    fn helpers(&self, functions: &[Function]) -> String {
        let statements = || functions.iter().flat_map(|f| &f.parts).flat_map(|p| &p.statements);
        let formulas = || statements().filter_map(value);
        let (real, f) = (self.real(), self.suffix());
        let fast = format!("FP_FAST_FMA{}", f.to_ascii_uppercase());
        let mut text = String::new();
        let uses_sign = |law: &LawFormula| law_calls(law, "sign");
        if formulas().any(|x| any(x, &|x| matches!(x, Formula::Sign(_))))
            || self.export.laws.iter().any(uses_sign)
        {
            let _ = writeln!(
                text,
                "/* -1, 0 or 1 with the sign of x. */\nstatic {real} sign({real} x)\n{{\n    return x > 0 ? 1 : x < 0 ? -1 : \
                 0;\n}}\n"
            );
        }
        if formulas().any(|x| any(x, &|x| matches!(x, Formula::InverseRoot(_)))) {
            let _ = writeln!(
                text,
                "/* 1 / sqrt(x), 0 where x is not above 0. */\nstatic {real} inverse_root({real} x)\n{{\n    return x > 0 ? 1 / \
                 sqrt{f}(x) : 0;\n}}\n"
            );
        }
        for (name, subtracted, a) in [("add_product", false, "a"), ("sub_product", true, "-a")] {
            let operator = if subtracted { '-' } else { '+' };
            let is_it =
                |x: &Formula| matches!(x, Formula::Accumulated { subtracted: s, .. } if *s == subtracted);
            if formulas().any(|x| any(x, &is_it)) {
                let _ = writeln!(
                    text,
                    "/* total {operator} a * b, rounded once where the machine has a fused multiply-add. */\nstatic {real} \
                     {name}({real} total, {real} a, {real} b)\n{{\n#ifdef {fast}\n    return fma{f}({a}, b, \
                     total);\n#else\n    return total {operator} a * b;\n#endif\n}}\n"
                );
            }
        }
        text
    }

    fn function(&self, text: &mut String, function: &Function) {
        let _ = writeln!(text, "{}\n{{", self.prototype(&function.signature));
        let mut unused: BTreeSet<&str> = function.signature.arguments.iter().map(|a| a.0).collect();
        for part in &function.parts {
            for statement in &part.statements {
                if let Statement::Unpack { array, .. } = statement {
                    unused.remove(array.as_str());
                }
            }
        }
        unused.iter().for_each(|name| _ = writeln!(text, "    (void){name};"));
        for statement in function.parts.iter().flat_map(|part| &part.statements) {
            self.statement(text, statement);
        }
        let _ = writeln!(text, "}}\n");
    }

    fn statement(&self, text: &mut String, statement: &Statement) {
        let (real, f) = (self.real(), self.suffix());
        // Writing to a String cannot fail.
        let _ = match statement {
            Statement::Unpack { array, values } => {
                for (k, name) in values.iter().enumerate() {
                    if let Some(name) = name {
                        let _ = writeln!(text, "    const {real} {name} = {array}[{k}];");
                    }
                }
                Ok(())
            }
            Statement::SinesAndCosines(pairs) => {
                for pair in pairs {
                    let angle = self.formula(&pair.angle);
                    for (name, function) in [(&pair.sine, "sin"), (&pair.cosine, "cos")] {
                        if let Some(name) = name {
                            let _ = writeln!(text, "    const {real} {name} = {function}{f}({angle});");
                        }
                    }
                }
                Ok(())
            }
            Statement::Comment(what) => writeln!(text, "    /* {what} */"),
            Statement::Let { name, value } => {
                writeln!(text, "    const {real} {name} = {};", self.formula(value))
            }
            Statement::Output { result, index, value } => {
                writeln!(text, "    {result}[{index}] = {};", self.formula(value))
            }
        };
    }

    fn formula(&self, formula: &Formula) -> String {
        let at_least = |operand: &Formula, binding: Binding| {
            let text = self.formula(operand);
            if operand.binding() < binding { format!("({text})") } else { text }
        };
        match formula {
            Formula::Constant(value) if *value < 0.0 => format!("({})", self.literal(*value)),
            Formula::Constant(value) => self.literal(*value),
            Formula::Variable(name) => name.clone(),
            Formula::Minus(a) => format!("-{}", at_least(a, Binding::Atom)),
            Formula::Sign(a) => format!("sign({})", self.formula(a)),
            Formula::InverseRoot(a) => format!("inverse_root({})", self.formula(a)),
            Formula::Sum(a, b) => {
                format!("{} + {}", at_least(a, Binding::Sum), at_least(b, Binding::Product))
            }
            Formula::Difference(a, b) => {
                format!("{} - {}", at_least(a, Binding::Sum), at_least(b, Binding::Product))
            }
            Formula::Product(a, b) => {
                format!("{} * {}", at_least(a, Binding::Product), at_least(b, Binding::Sign))
            }
            Formula::Accumulated { total, factors, subtracted } => {
                let name = if *subtracted { "sub_product" } else { "add_product" };
                let [a, b] = factors.each_ref().map(|x| self.formula(x));
                format!("{name}({}, {a}, {b})", self.formula(total))
            }
        }
    }

    /// A number with as many digits as its type takes.
    fn literal(&self, value: f64) -> String {
        match self.real {
            Real::Single => format!("{:?}f", value as f32),
            Real::Double => format!("{value:?}"),
        }
    }

    /// The function of the identified model.
    fn known_torques(&self, text: &mut String) {
        let (name, real, export) = (&self.export.name, self.real(), self.export);
        let _ = writeln!(text, "{}\n{{", self.known_prototype());
        let inputs: BTreeSet<_> = export.laws.iter().flat_map(LawFormula::inputs).collect();
        if export.needs_loads() {
            let _ = writeln!(text, "    {real} load[{}_N];", self.upper());
        }
        for input in inputs.iter().filter(|i| i.array != "load") {
            let _ = writeln!(text, "    const {real} {} = {}[{}];", input.name, input.array, input.joint);
        }
        let _ = writeln!(text, "    {name}_tau({name}_chi, q, dq, ddq, tau);");
        if export.needs_loads() {
            let _ = writeln!(text, "    {name}_tau({name}_chi_load, q, dq, ddq, load);");
        }
        let known = export.known.map_or(&[][..], |known| &known.laws);
        for (law, formula) in known.iter().zip(&export.laws) {
            let _ = writeln!(text, "    /* {} */", plain(&law.title));
            let _ = writeln!(text, "    tau[{}] += {};", law.joint, self.law(formula));
        }
        let _ = writeln!(text, "}}");
    }

    fn law(&self, law: &LawFormula) -> String {
        let at_least = |operand: &LawFormula, binding: Binding| {
            let text = self.law(operand);
            if operand.binding() < binding { format!("({text})") } else { text }
        };
        match law {
            LawFormula::Number(x) => self.literal(*x),
            LawFormula::Input(input) if input.array == "load" => format!("load[{}]", input.joint),
            LawFormula::Input(input) => input.name.clone(),
            LawFormula::Negative(a) => format!("-{}", at_least(a, Binding::Atom)),
            LawFormula::Combined('^', both) => {
                format!("pow{}({}, {})", self.suffix(), self.law(&both[0]), self.law(&both[1]))
            }
            LawFormula::Combined(operator, both) => {
                let [left, right] = LawFormula::operands(*operator);
                format!("{} {operator} {}", at_least(&both[0], left), at_least(&both[1], right))
            }
            LawFormula::Call(k, a) => {
                let [_, name, _] = FUNCTIONS[*k];
                let suffix = if name == "sign" { "" } else { self.suffix() };
                format!("{name}{suffix}({})", self.law(a))
            }
        }
    }
}

/// The formula of a statement.
fn value(statement: &Statement) -> Option<&Formula> {
    match statement {
        Statement::Let { value, .. } | Statement::Output { value, .. } => Some(value),
        Statement::Unpack { .. } | Statement::SinesAndCosines(_) | Statement::Comment(_) => None,
    }
}

/// Whether a formula or a part of it is of a kind.
fn any(formula: &Formula, is_it: &impl Fn(&Formula) -> bool) -> bool {
    is_it(formula)
        || match formula {
            Formula::Constant(_) | Formula::Variable(_) => false,
            Formula::Minus(a) | Formula::Sign(a) | Formula::InverseRoot(a) => any(a, is_it),
            Formula::Sum(a, b) | Formula::Difference(a, b) | Formula::Product(a, b) => {
                any(a, is_it) || any(b, is_it)
            }
            Formula::Accumulated { total, factors, .. } => {
                any(total, is_it) || factors.iter().any(|a| any(a, is_it))
            }
        }
}

/// Whether a law calls a function, by its name in a law.
fn law_calls(law: &LawFormula, name: &str) -> bool {
    match law {
        LawFormula::Number(_) | LawFormula::Input(_) => false,
        LawFormula::Negative(a) => law_calls(a, name),
        LawFormula::Combined(_, both) => both.iter().any(|a| law_calls(a, name)),
        LawFormula::Call(k, a) => FUNCTIONS[*k][0] == name || law_calls(a, name),
    }
}

/// Text that cannot end the comment that it stands in.
fn plain(text: &str) -> String {
    text.replace("*/", "* /").replace("/*", "/ *")
}

/// A comment of several lines.
fn comment(lines: &[String]) -> String {
    let mut text = String::from("/*\n");
    for line in lines {
        let line = plain(line);
        let _ = writeln!(text, "{}", format!(" * {line}").trim_end());
    }
    text.push_str(" */\n");
    text
}

/// Values of an array, a few on a line.
pub fn wrapped(values: &[String]) -> String {
    let mut text = String::new();
    let mut line = String::new();
    for value in values {
        if line.len() + value.len() > 96 {
            let _ = writeln!(text, "   {line}");
            line.clear();
        }
        let _ = write!(line, " {value},");
    }
    let _ = writeln!(text, "   {line}");
    text
}
