fn main() {
    for path in std::env::args().skip(1) {
        let r = dynid_codegen::robot::parse(&path, &std::fs::read(&path).unwrap()).unwrap();
        let t = std::time::Instant::now();
        let b = dynid_codegen::base::base_set(&r);
        println!("{} {} in {:?}", r.name, b.base.len(), t.elapsed());
        if std::env::var("V").is_ok() {
            for p in &b.base {
                println!("  {:6} [{}] = {}", p.name, p.unit, p.relation);
            }
            println!(
                "  none: {:?}",
                b.without_effect().iter().map(|&k| &b.standard[k].name).collect::<Vec<_>>()
            );
        }
    }
}
