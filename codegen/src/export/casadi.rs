//! The interface by which CasADi loads functions of a library (`casadi.external`), over exported C.
//!
//! CasADi user guide, "Using C/C++ functions": sizes, names and sparsities of inputs and outputs, and the call itself, in which
//! an input without a pointer is zero and an output without one is not wanted.

use super::{CasadiFile, Export};
use crate::emit::functions;
use std::fmt::Write;

/// What stands above the functions.
const OPENING: &str = r#"
#ifndef casadi_int
#define casadi_int long long int
#endif

#ifndef CASADI_SYMBOL_EXPORT
#if defined(_WIN32) || defined(__CYGWIN__)
#define CASADI_SYMBOL_EXPORT __declspec(dllexport)
#else
#define CASADI_SYMBOL_EXPORT
#endif
#endif

#ifdef __cplusplus
extern "C" {
#endif
"#;

/// A function as CasADi sees it.
struct External<'a> {
    /// The C function that does the work, without the robot's name.
    name: &'a str,
    inputs: Vec<(&'a str, usize)>,
    outputs: Vec<(&'a str, Shape)>,
}

/// The shape of an output.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    /// Rows and columns, column by column; all matrices of more than one row and column are symmetric.
    Dense(usize, usize),
    /// IDM in the order of its columns.
    Regressor,
}

/// The file of a robot.
pub fn file(export: &Export<'_>) -> CasadiFile {
    let (rows, columns) = export.pattern();
    let sizes = Sizes { n: rows.len() - 1, nb: export.set.base.len(), entries: columns.len() };
    let name = &export.name;
    let functions = functions(&export.table, &export.set, &export.equations, usize::MAX);
    let mut externals: Vec<External<'_>> = functions
        .iter()
        .map(|f| External {
            name: f.signature.name,
            inputs: f.signature.arguments.iter().map(|(name, size)| (*name, sizes.of(size))).collect(),
            outputs: f.signature.results.iter().map(|(name, _)| (*name, sizes.shape(name))).collect(),
        })
        .collect();
    if export.known.is_some() {
        let state = ["q", "dq", "ddq"].map(|x| (x, sizes.n)).to_vec();
        externals.push(External {
            name: "model_tau",
            inputs: state,
            outputs: vec![("tau", sizes.shape("tau"))],
        });
    }
    let mut text = format!(
        "/* {name} for CasADi: cc -O3 -shared -fPIC {name}.c {name}_casadi.c -lm -o {name}.so, and in Python\n * \
         casadi.external(\"casadi_{name}_tau\", \"./{name}.so\"). Derivatives are not here: {{\"enable_fd\": True}}. */\n\
         #include \"{name}.h\"\n{OPENING}"
    );
    let longest = externals.iter().flat_map(|e| &e.inputs).map(|(_, size)| *size).max().unwrap_or(1);
    let _ = writeln!(text, "\nstatic const double zeros[{longest}] = {{0}};");
    regressor(&mut text, (sizes.n, sizes.nb), &rows, &columns);
    externals.iter().for_each(|external| external.write(&mut text, name, sizes));
    text.push_str("\n#ifdef __cplusplus\n}\n#endif\n");
    CasadiFile { name: format!("{name}_casadi"), source: text }
}

/// The sizes of a robot.
#[derive(Clone, Copy)]
struct Sizes {
    n: usize,
    nb: usize,
    entries: usize,
}

impl Sizes {
    /// A size by its name in the header.
    fn of(self, size: &str) -> usize {
        if size == "NB" { self.nb } else { self.n }
    }

    /// The shape of a result by its name.
    fn shape(self, result: &str) -> Shape {
        match result {
            "h" | "dh" => Shape::Dense(1, self.nb),
            "idm" => Shape::Regressor,
            "mass" => Shape::Dense(self.n, self.n),
            _ => Shape::Dense(self.n, 1),
        }
    }

    /// Numbers of an output.
    fn count(self, shape: Shape) -> usize {
        match shape {
            Shape::Dense(rows, columns) => rows * columns,
            Shape::Regressor => self.entries,
        }
    }
}

/// The sparsity of IDM by columns, and the entry of the C function that each of its entries is.
fn regressor(text: &mut String, (n, nb): (usize, usize), rows: &[usize], columns: &[usize]) {
    let row_of = |entry: usize| rows.iter().filter(|&&first| first <= entry).count() - 1;
    let mut order: Vec<usize> = (0..columns.len()).collect();
    order.sort_by_key(|&entry| (columns[entry], entry));
    let starts = (0..=nb).map(|column| columns.iter().filter(|&&c| c < column).count());
    let sparsity: Vec<usize> =
        [n, nb].into_iter().chain(starts).chain(order.iter().map(|&entry| row_of(entry))).collect();
    for (kind, array, values) in [("casadi_int", "idm_sparsity", &sparsity), ("int", "idm_order", &order)] {
        let values: Vec<String> = values.iter().map(ToString::to_string).collect();
        let _ = writeln!(
            text,
            "\nstatic const {kind} {array}[{}] = {{\n{}}};",
            values.len(),
            super::c::wrapped(&values)
        );
    }
}

impl External<'_> {
    fn write(&self, text: &mut String, robot: &str, sizes: Sizes) {
        let own = format!("casadi_{robot}_{}", self.name);
        let names = |all: &[&str]| all.iter().map(|x| format!("\"{x}\"")).collect::<Vec<_>>().join(", ");
        let inputs: Vec<&str> = self.inputs.iter().map(|i| i.0).collect();
        let outputs: Vec<&str> = self.outputs.iter().map(|o| o.0).collect();
        for (end, all) in [("in", &inputs), ("out", &outputs)] {
            let count = all.len();
            let _ = writeln!(
                text,
                "\nCASADI_SYMBOL_EXPORT casadi_int {own}_n_{end}(void)\n{{\n    return {count};\n}}\n\n\
                 CASADI_SYMBOL_EXPORT const char *{own}_name_{end}(casadi_int i)\n{{\n    static const char *const names[] \
                 = {{{}}};\n    return i >= 0 && i < {count} ? names[i] : 0;\n}}",
                names(all)
            );
        }
        let ins: Vec<Shape> = self.inputs.iter().map(|&(_, size)| Shape::Dense(size, 1)).collect();
        let outs: Vec<Shape> = self.outputs.iter().map(|&(_, shape)| shape).collect();
        for (end, shapes) in [("in", &ins), ("out", &outs)] {
            sparsity(text, &format!("{own}_sparsity_{end}"), shapes);
        }
        let room: usize = self.outputs.iter().map(|&(_, shape)| sizes.count(shape)).sum();
        let _ = writeln!(
            text,
            "\nCASADI_SYMBOL_EXPORT int {own}_work(casadi_int *sz_arg, casadi_int *sz_res, casadi_int *sz_iw, casadi_int \
             *sz_w)\n{{\n    if (sz_arg) *sz_arg = {};\n    if (sz_res) *sz_res = {};\n    if (sz_iw) *sz_iw = 0;\n    if \
             (sz_w) *sz_w = {room};\n    return 0;\n}}",
            inputs.len(),
            outputs.len()
        );
        self.call(text, &own, robot, sizes);
    }

    /// The call: results that are not wanted, and entries that must change places, go to the room that CasADi lends.
    fn call(&self, text: &mut String, own: &str, robot: &str, sizes: Sizes) {
        let _ = writeln!(
            text,
            "\nCASADI_SYMBOL_EXPORT int {own}(const double **arg, double **res, casadi_int *iw, double *w, int mem)\n{{"
        );
        let mut arguments = Vec::new();
        for (k, (name, _)) in self.inputs.iter().enumerate() {
            let _ = writeln!(text, "    const double *{name} = arg[{k}] ? arg[{k}] : zeros;");
            arguments.push(*name);
        }
        let mut at = 0;
        for (k, &(name, shape)) in self.outputs.iter().enumerate() {
            let place = match shape {
                Shape::Dense(..) => format!("res[{k}] ? res[{k}] : w + {at}"),
                Shape::Regressor => format!("w + {at}"),
            };
            let _ = writeln!(text, "    double *{name} = {place};");
            at += sizes.count(shape);
            arguments.push(name);
        }
        let _ = writeln!(
            text,
            "    (void)iw;\n    (void)mem;\n    {robot}_{}({});",
            self.name,
            arguments.join(", ")
        );
        for (k, (name, _)) in self.outputs.iter().enumerate().filter(|(_, o)| o.1 == Shape::Regressor) {
            let _ = writeln!(
                text,
                "    if (res[{k}]) {{\n        int entry;\n        for (entry = 0; entry < {}; entry++)\n            \
                 res[{k}][entry] = {name}[idm_order[entry]];\n    }}",
                sizes.entries
            );
        }
        text.push_str("    return 0;\n}\n");
    }
}

/// The function that tells the sparsities of inputs or of outputs.
fn sparsity(text: &mut String, name: &str, shapes: &[Shape]) {
    let _ = writeln!(text, "\nCASADI_SYMBOL_EXPORT const casadi_int *{name}(casadi_int i)\n{{");
    for (k, shape) in shapes.iter().enumerate() {
        let sparsity = match shape {
            // A 1 in the place of the columns is dense.
            Shape::Dense(rows, columns) => {
                let _ =
                    writeln!(text, "    static const casadi_int dense_{k}[3] = {{{rows}, {columns}, 1}};");
                format!("dense_{k}")
            }
            Shape::Regressor => "idm_sparsity".to_owned(),
        };
        let _ = writeln!(text, "    if (i == {k})\n        return {sparsity};");
    }
    text.push_str("    return 0;\n}\n");
}
