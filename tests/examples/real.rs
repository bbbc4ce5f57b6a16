use floe_core::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let col: usize = a[2].parse().unwrap();
    let w: f32 = a[3].parse().unwrap();
    let hz: f32 = a[4].parse().unwrap();
    let text = std::fs::read_to_string(&a[1]).unwrap();
    let mut pl = Pipeline::new(&Config { rate_hz: hz, weight_n: w, ..Config::default() }).unwrap();
    let mut ev = vec![];
    let mut range = (f32::MAX, f32::MIN);
    for (i, l) in text.lines().filter(|l| !l.starts_with('#')).skip(1).enumerate() {
        let f: f32 = l.split(',').nth(col).unwrap().parse().unwrap();
        range = (range.0.min(f), range.1.max(f));
        if let Some(e) =
            pl.step(RawSample { index: i as u64, reading: Reading::Force(Newtons(f)) }).event
        {
            ev.push(e);
        }
    }
    while let Some(e) = pl.finish() {
        ev.push(e);
    }
    let out = ev
        .iter()
        .filter(|e| e.mu_s.is_some() && (e.static_force_n > range.1 || e.restick_force_n < range.0))
        .count();
    if a.len() > 5 {
        for e in &ev {
            println!(
                "{} {:.2} Fs {:.4} Fp {:.4} Fe {:.4} slip {:.3} r {:.5} std {:?} {:?} {:?} {:?}",
                e.index,
                e.onset.index as f32 + e.onset.fraction,
                e.static_force_n,
                e.dynamic_force_n,
                e.restick_force_n,
                e.slip_s,
                e.loading_rate_n_per_s,
                e.mu_s.map(|m| m.std),
                e.mu.map(|m| m.std),
                e.quality,
                e.reason
            );
        }
    }
    println!(
        "events {} null {} outside {} range {range:?} good {}",
        ev.len(),
        ev.iter().filter(|e| e.mu_s.is_none()).count(),
        out,
        ev.iter().filter(|e| e.quality == Quality::Good).count()
    );
    println!("{:#?}", pl.report());
}
