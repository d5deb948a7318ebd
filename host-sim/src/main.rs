//! scratch
fn main() {
    let config = fdi_core::Config::default();
    for seed in 1..4 {
        let r = host_sim::experiment::run(&config, &host_sim::scenario::Scenario::default(), seed).unwrap();
        let s = host_sim::summary::Summary::new(&r);
        println!("{}", serde_json::to_string(&s).unwrap());
    }
}
