//! How the relation between a base parameter and the standard ones is written down.

use crate::exact::Form;

/// Parameters with one factor, each with its sign within the product.
struct Product<'a> {
    sign: char,
    factor: String,
    names: Vec<(char, &'a str)>,
}

/// `ZZ1 + Ia1 + d3^2*(M3 + M4)`: the kept parameter, and what was regrouped into it with its factors. Parameters with the
/// same factor, but for its sign, stand together where the first of them does.
pub(super) fn relation(kept: &str, regrouped: &[(&str, &Form)]) -> String {
    let mut products: Vec<Product<'_>> = Vec::new();
    for &(name, form) in regrouped {
        let (sign, factor) = form.signed_factor();
        match products.iter_mut().find(|product| !factor.is_empty() && product.factor == factor) {
            Some(product) => product.names.push((if sign == product.sign { '+' } else { '-' }, name)),
            None => products.push(Product { sign, factor, names: vec![('+', name)] }),
        }
    }
    let mut text = kept.to_owned();
    for Product { sign, factor, names } in &products {
        let names: Vec<String> = names
            .iter()
            .enumerate()
            .map(|(k, (sign, name))| if k == 0 { (*name).to_owned() } else { format!(" {sign} {name}") })
            .collect();
        let product = match (factor.is_empty(), names.len()) {
            (true, _) => names.concat(),
            (false, 1) => format!("{factor}*{}", names.concat()),
            (false, _) => format!("{factor}*({})", names.concat()),
        };
        text.push_str(&format!(" {sign} {product}"));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{Number, decimal};

    #[test]
    fn parameters_with_one_factor_stand_together() {
        let d = Form::named("d3", decimal(0.5).into());
        let square = d.times(&d).plus(&Form::one());
        let (one, minus) = (Form::one(), d.scaled(-Number::ONE));
        let text =
            relation("ZZ1", &[("Ia1", &one), ("MX2", &d), ("M3", &square), ("MX4", &minus), ("M4", &square)]);
        assert_eq!(text, "ZZ1 + Ia1 + d3*(MX2 - MX4) + (d3^2 + 1)*(M3 + M4)");
        assert_eq!(relation("MX2", &[("M3", &minus), ("M4", &minus)]), "MX2 - d3*(M3 + M4)");
        assert_eq!(relation("MX2", &[]), "MX2");
    }
}
