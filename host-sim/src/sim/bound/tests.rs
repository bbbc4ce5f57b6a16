//! Bounds compared with differences of the model and with published figures.

use super::*;

fn dff8_13() -> LinearEvent {
    LinearEvent {
        onset_s: 0.0,
        loading_rate_n_per_s: 360.0,
        static_force_n: 1.24 * 630.0,
        dynamic_force_n: 0.78 * 630.0,
        omega_rad_per_s: (23_000.0_f64 / (630.0 / 9.806_65)).sqrt(),
    }
}

fn slack() -> SlackEvent {
    let (static_force_n, dynamic_force_n) = (630.0, 252.0);
    SlackEvent {
        taut: LinearEvent { static_force_n, dynamic_force_n, ..dff8_13() },
        mass_kg: 630.0 / 9.806_65,
    }
}

/// The bound of `Fs` with `k w` and `omega` known from elsewhere, N.
fn with_known_rate_n(event: &LinearEvent, times_s: impl Iterator<Item = f64>) -> f64 {
    let mut fisher = fisher(times_s.map(|t| event.gradient(t)));
    // A known parameter has no correlation with the others.
    let known = |i: usize| i == RATE || i == OMEGA;
    for (i, row) in fisher.iter_mut().enumerate() {
        for (j, cell) in row.iter_mut().enumerate().filter(|(j, _)| known(i) || known(*j)) {
            *cell = if i == j { 1.0 } else { 0.0 };
        }
    }
    ForceBound::new(&inverse(fisher).unwrap(), 1.0).static_n
}

/// Root-mean-square of the bounds over sampling phases, in units of sigma:
/// `Fs`, `Fp`, and `Fs` with rate and omega known.
fn mean_bounds(event: LinearEvent) -> (f64, f64, f64) {
    let phases = 64;
    let (mut squares, mut known) = ((0.0, 0.0), 0.0);
    for phase in 0..phases {
        let shift = f64::from(phase) / f64::from(phases) / 16.0;
        let end = event.slip_s() + event.stick_s();
        let first = ((-event.stick_s() - shift) * 16.0).ceil() as i64;
        let last = ((end - shift) * 16.0).floor() as i64;
        let times = || (first..=last).map(|n| n as f64 / 16.0 + shift);
        let bound = event.bound(times(), 1.0).unwrap();
        squares.0 += bound.static_n.powi(2);
        squares.1 += bound.dynamic_n.powi(2);
        known += with_known_rate_n(&event, times()).powi(2);
    }
    let root = |square: f64| (square / f64::from(phases)).sqrt();
    (root(squares.0), root(squares.1), root(known))
}

/// The model of the module's head, coded separately, as a function of the unknowns in their order;
/// with a mass, for a block that stops on a slack cable.
fn force_n(unknowns: &[f64; 5], mass_kg: Option<f64>, time_s: f64) -> f64 {
    let [onset_s, rate, fs, fp, omega] = *unknowns;
    let t = time_s - onset_s;
    let (a, b) = (fs - fp, rate / omega);
    let slip_s = 2.0 / omega * (PI - a.atan2(b));
    let slip_n = |t: f64| fp + a * (omega * t).cos() + b * (omega * t).sin();
    let Some(mass_kg) = mass_kg else {
        let rest_n = 2.0 * fp - fs + rate * (t - slip_s);
        return if t < 0.0 {
            fs + rate * t
        } else if t < slip_s {
            slip_n(t)
        } else {
            rest_n
        };
    };
    // Zero of the force, by bisection up to its lowest point.
    let (mut low, mut high) = (0.0, PI / omega);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slip_n(middle) > 0.0 { low = middle } else { high = middle }
    }
    let winch = rate / (omega * omega * mass_kg);
    let falling = omega * (-a * (omega * low).sin() + b * (omega * low).cos());
    let speed = winch - falling / (omega * omega * mass_kg);
    let deceleration = fp / mass_kg;
    let stop_s = speed / deceleration;
    let slack_m = 0.5 * deceleration * stop_s * stop_s - winch * stop_s;
    let rises_s = low + stop_s + slack_m / winch;
    if t < 0.0 {
        fs + rate * t
    } else if t < low {
        slip_n(t)
    } else {
        (rate * (t - rises_s)).max(0.0)
    }
}

/// Compares a gradient with differences of the model.
fn assert_derivatives(event: &LinearEvent, mass_kg: Option<f64>, time_s: f64, found: [f64; 5]) {
    let (rate, omega) = (event.loading_rate_n_per_s, event.omega_rad_per_s);
    let unknowns = [event.onset_s, rate, event.static_force_n, event.dynamic_force_n, omega];
    for (i, analytic) in found.into_iter().enumerate() {
        let moved = |h: f64| {
            let mut unknowns = unknowns;
            unknowns[i] += h;
            force_n(&unknowns, mass_kg, time_s)
        };
        let h = 1e-5;
        let numeric = (moved(h) - moved(-h)) / (2.0 * h);
        let close = (numeric - analytic).abs() < 1e-5 * (1.0 + analytic.abs());
        assert!(close, "{time_s} {i}: {numeric} {analytic}");
    }
}

#[test]
fn gradients_are_derivatives() {
    let (taut, slack) = (dff8_13(), slack());
    let times_s = [-1.0, -0.1, 0.03, 0.09, 0.15, 0.3, 0.85, 1.2, 2.0, 3.0];
    for (time_s, of_slack) in times_s.into_iter().zip(slack.gradients(times_s.into_iter()).unwrap())
    {
        assert_derivatives(&taut, None, time_s, taut.gradient(time_s));
        assert_derivatives(&slack.taut, Some(slack.mass_kg), time_s, of_slack);
    }
    assert!(slack.slack_s().unwrap().1 < 2.0, "the last times must be on the line after");
}

#[test]
fn bounds_agree_with_the_published_figures_of_the_model() {
    let (static_n, dynamic_n, known_n) = mean_bounds(dff8_13());
    println!("DFF8-13: mu_s {static_n:.3}, mu {dynamic_n:.3}, known {known_n:.3} sigma/Mg");
    assert!((static_n - 0.32).abs() < 0.02 && (dynamic_n - 0.14).abs() < 0.01);
    assert!((known_n - 0.20).abs() < 0.01);
}

#[test]
fn a_slip_without_samples_has_no_bound() {
    let event = dff8_13();
    let times = [-1.0, -0.5, -0.01, 0.2, 0.5, 1.0].into_iter();
    assert_eq!(event.bound(times, 1.0), None);
}
