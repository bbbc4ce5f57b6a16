use floe_core::*;
use floe_tests::brute::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let scene = a.get(1).map(String::as_str).unwrap_or("dff8");
    let sigma_rel: f64 = a.get(2).map(|s| s.parse().unwrap()).unwrap_or(f64::NAN);
    let verbose = a.get(3).is_some();
    let d = Pull::default();
    let k = 23000.0;
    let mut p = match scene {
        "dff8" => Pull { noise_n: 2.0, ..d },
        "heavy" => Pull { weight_n: 3000.0, mu_s: 0.9, mu: 0.55, noise_n: 2.0, ..d },
        "fast" => Pull { winch_m_per_s: 0.04, noise_n: 2.0, ..d },
        "snow" => Pull { weight_n: 900.0, mu_s: 1.0, mu: 0.62, noise_n: 2.0, ..d },
        "light" => Pull { weight_n: 300.0, mu_s: 0.9, mu: 0.56, noise_n: 2.0, ..d },
        "stiff" => {
            Pull { stiffness_n_per_m: 230000.0, noise_n: 2.0, winch_m_per_s: 360.0 / k, ..d }
        }
        "small" => Pull { mu_s: 0.81, noise_n: 2.0, ..d },
        "vary" => Pull { variation: 0.1, noise_n: 2.0, ..d },
        "ripple" => Pull { ripple: (0.3, 2.3), noise_n: 2.0, ..d },
        "ripple1" => Pull { ripple: (0.3, 0.7), noise_n: 2.0, ..d },
        "slope" => Pull { slope_rad: 0.105, noise_n: 2.0, ..d },
        "slack" => Pull { mu_s: 1.0, mu: 0.4, noise_n: 2.0, ..d },
        "sag" => Pull { sag_n2_m: 228.0, noise_n: 2.0, ..d },
        "aperture" => Pull { aperture_s: 0.05, noise_n: 2.0, ..d },
        "noflat" => Pull { winch_m_per_s: 0.3, noise_n: 2.0, ..d },
        "slow" => Pull { winch_m_per_s: 0.001, noise_n: 2.0, duration_s: 1200.0, ..d },
        "rate100" => Pull { rate_hz: 100.0, noise_n: 2.0, ..d },
        "rate500" => Pull { rate_hz: 500.0, noise_n: 2.0, ..d },
        _ => panic!(),
    };
    if sigma_rel.is_finite() {
        p.noise_n = sigma_rel * p.weight_n;
    }
    let (mut es, mut em, mut zs, mut zm, mut n, mut truth_n, mut found_n) =
        (vec![], vec![], vec![], vec![], 0, 0, 0);
    let mut chi = 0.0;
    let (mut s_std, mut m_std) = (0.0, 0.0);
    for seed in 0..8u64 {
        let q = Pull { delay_s: 0.0625 * (seed as f64) / 8.0, ..p };
        let r = run(&q, seed + 1);
        let mut pl = Pipeline::new(&Config {
            rate_hz: p.rate_hz as f32,
            weight_n: p.weight_n as f32,
            slope_rad: p.slope_rad as f32,
            ..Config::default()
        })
        .unwrap();
        let mut ev = vec![];
        for (i, f) in r.forces_n.iter().enumerate() {
            if let Some(e) = pl
                .step(RawSample { index: i as u64, reading: Reading::Force(Newtons(*f as f32)) })
                .event
            {
                ev.push(e);
            }
        }
        while let Some(e) = pl.finish() {
            ev.push(e);
        }
        truth_n += r.events.len();
        found_n += ev.len();
        for e in &ev {
            let t = q.delay_s + (e.onset.index as f64 + e.onset.fraction as f64) / p.rate_hz;
            let Some(tr) = r
                .events
                .iter()
                .min_by(|a, b| (a.onset_s - t).abs().total_cmp(&(b.onset_s - t).abs()))
            else {
                continue;
            };
            if verbose && seed == 0 {
                println!(
                    "{:3} t {:8.3} dt {:7.4} Fs {:7.1} ({:7.1}) Fp {:7.1} ({:7.1}) slip {:.3} ({:.3}) om {:?} r {:.1} mus {:?} q {:?} {:?}",
                    e.index,
                    t,
                    t - tr.onset_s,
                    e.static_force_n,
                    tr.static_n,
                    e.dynamic_force_n,
                    tr.mu * p.weight_n,
                    e.slip_s,
                    tr.stop_s - tr.onset_s,
                    e.omega_rad_per_s,
                    e.loading_rate_n_per_s,
                    e.mu_s.map(|m| m.std * p.weight_n as f32),
                    e.quality,
                    e.reason
                );
            }
            if (t - tr.onset_s).abs() < 0.15 {
                n += 1;
            }
            if e.index < 3 {
                continue;
            }
            if let (Some(a), Some(b)) = (e.mu_s, e.mu) {
                let (da, db) = (a.value as f64 - tr.mu_s, b.value as f64 - tr.mu);
                es.push(da / tr.mu_s);
                em.push(db / tr.mu);
                zs.push(da / a.std as f64);
                zm.push(db / b.std as f64);
                s_std += a.std as f64;
                m_std += b.std as f64;
            }
        }
        if seed == 0 {
            let rep = pl.report();
            chi = rep.noise_n.unwrap_or(0.0) as f64;
            println!(
                "{scene}: {:?} {:?} noise {:?} rate {:?} omega {:?}",
                rep.mu_s, rep.mu, rep.noise_n, rep.loading_rate_n_per_s, rep.omega_rad_per_s
            );
        }
    }
    let st = |v: &Vec<f64>| {
        let n = v.len() as f64;
        let m = v.iter().sum::<f64>() / n;
        let r = (v.iter().map(|x| x * x).sum::<f64>() / n).sqrt();
        let mut a: Vec<f64> = v.iter().map(|x| x.abs()).collect();
        a.sort_by(f64::total_cmp);
        (m, r, a[((a.len() as f64) * 0.95) as usize])
    };
    let cover = |v: &Vec<f64>| v.iter().filter(|z| z.abs() < 1.96).count() as f64 / v.len() as f64;
    let (a, b) = (st(&es), st(&em));
    let N = es.len() as f64;
    let sw = p.noise_n / p.weight_n;
    println!(
        "  truth {truth_n} found {found_n} matched {n} | mu_s bias {:+.3}% rms {:.3}% p95 {:.3}% cover {:.3} | mu bias {:+.3}% rms {:.3}% p95 {:.3}% cover {:.3} | in sigma/W: rms {:.3} {:.3} stated {:.3} {:.3} chi {chi:.2}",
        a.0 * 100.,
        a.1 * 100.,
        a.2 * 100.,
        cover(&zs),
        b.0 * 100.,
        b.1 * 100.,
        b.2 * 100.,
        cover(&zm),
        a.1 * p.mu_s / sw,
        b.1 * p.mu / sw,
        s_std / N / sw,
        m_std / N / sw
    );
}
