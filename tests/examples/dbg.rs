use floe_core::*;
use floe_tests::brute::*;
fn main() {
    let d = Pull::default();
    let a: Vec<String> = std::env::args().collect();
    let p = match a[1].as_str() {
        "stiff" => Pull { stiffness_n_per_m: 230000.0, noise_n: 2.0, duration_s: 30.0, ..d },
        _ => Pull { mu_s: 0.81, noise_n: 2.0, duration_s: 30.0, ..d },
    };
    let r = run(&p, 1);
    let mut det = detector::Detector::new(16.0);
    let mut k = 0;
    for (i, f) in r.forces_n.iter().enumerate() {
        let t = i as f64 / 16.0;
        let tr = det.step(i as u64, *f as f32);
        while k < r.events.len() && r.events[k].onset_s < t {
            println!("   true onset {:.3} Fs {:.1}", r.events[k].onset_s, r.events[k].static_n);
            k += 1;
        }
        println!(
            "{i} {t:.3} {f:.1} {:?} std {:?} drop {} {:?}",
            det.phase(),
            det.noise_n(),
            det.usual_drop_n(),
            tr
        );
        if k > a[2].parse().unwrap() {
            break;
        }
    }
}
