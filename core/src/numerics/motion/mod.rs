//! Motion of a body under a position-dependent force f with viscous damping: M ü = f(u) − γ u̇.
//!
//! Where f is smooth, Gauss collocation with 16 stages, of order 32 and A-stable (E. Hairer, S. P. Nørsett
//! and G. Wanner, *Solving Ordinary Differential Equations I*, 1993, II.7 and II.14). Where f is linear in u,
//! the closed form, or with damping the power series of u in time.

mod passage;
mod step;

pub use passage::uniform;
pub use step::MotionStep;

/// Mass and damping of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// M > 0.
    pub mass: f64,
    /// γ ≥ 0, force per velocity.
    pub damping: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Place and speed of ü + 2βu̇ + ω²u = g from rest at 0.
    fn oscillator(beta: f64, square: f64, push: f64, time: f64) -> (f64, f64) {
        let (omega, away) = ((square - beta * beta).sqrt(), push / square);
        let (sin, cos) = (omega * time).sin_cos();
        let decay = (-beta * time).exp();
        let place = away * (1.0 - decay * (cos + beta / omega * sin));
        (place, away * decay * square / omega * sin)
    }

    const BODY: Body = Body { mass: 2.0, damping: 0.4 };
    const PUSH: f64 = 1.5;
    const RESISTANCE: f64 = 3.0;

    #[test]
    fn a_step_follows_a_damped_oscillator() {
        let force = |u: f64| (PUSH - RESISTANCE * u, -RESISTANCE);
        let step = BODY.step((0.0, 0.0), 2.0, 1e-13, force).unwrap();
        for s in [0.3, 1.0] {
            let (place, speed) = oscillator(0.1, 1.5, 0.75, 2.0 * s);
            let found = step.at(s);
            // Rounding of sums over 16 points.
            assert!((found.0 - place).abs() < 1e-14 && (found.1 - speed).abs() < 1e-14, "{found:?}");
        }
        // Work done against the damping: what the force gave less what is stored and moves.
        let (place, speed) = step.at(1.0);
        let lost = PUSH * place - 0.5 * RESISTANCE * place * place - 0.5 * BODY.mass * speed * speed;
        assert!((BODY.damping * step.squared() - lost).abs() < 1e-14);
        assert_eq!(BODY.step((0.0, 0.0), 40.0, 1e-13, force), None);
    }

    #[test]
    fn passages_add_up_to_the_first_rest_of_a_damped_oscillator() {
        let (mut place, mut speed, mut time, mut squared) = (0.0, 0.0, 0.0, 0.0);
        loop {
            let passage = BODY.passage(speed, PUSH - RESISTANCE * place, RESISTANCE, 0.07);
            (place, speed, time) = (place + passage.distance, passage.speed, time + passage.time);
            squared += passage.squared;
            if speed == 0.0 {
                break;
            }
            let exact = oscillator(0.1, 1.5, 0.75, time);
            // Rounding of some twenty passages, and of a time that a slow beginning magnifies.
            assert!((place - exact.0).abs() < 1e-13 && (speed - exact.1).abs() < 1e-13, "{time} {exact:?}");
        }
        let rest = std::f64::consts::PI / (1.5_f64 - 0.01).sqrt();
        // The way is flat where it ends: time is known to the root of its rounding.
        assert!((time - rest).abs() < 1e-7 && (place - oscillator(0.1, 1.5, 0.75, rest).0).abs() < 1e-13);
        let lost = PUSH * place - 0.5 * RESISTANCE * place * place;
        assert!((BODY.damping * squared - lost).abs() < 1e-13);
    }

    /// Passages, in closed form and as series, against collocation over as much time: through, to rest, over a force
    /// that grows on the way, and with more damping than lets a body swing.
    #[test]
    fn passages_are_steps() {
        let cases = [
            (0.0, PUSH, RESISTANCE, 0.3),
            (1.0, -PUSH, RESISTANCE, 0.1),
            (1.0, -PUSH, RESISTANCE, 9.0),
            (1.0, PUSH, -RESISTANCE, 0.7),
            (1.0, -PUSH, -RESISTANCE, 0.2),
            (0.5, -PUSH, -RESISTANCE, 0.7),
            (0.5, -PUSH, 0.0, 9.0),
        ];
        for damping in [0.0, 0.4, 9.0] {
            for (speed, excess, resistance, length) in cases {
                let body = Body { mass: 2.0, damping };
                let passage = body.passage(speed, excess, resistance, length);
                let force = |u: f64| (excess - resistance * u, -resistance);
                let step = body.step((0.0, speed), passage.time, 1e-13, force).unwrap();
                let (place, end) = step.at(1.0);
                let squared = if damping > 0.0 { step.squared() } else { 0.0 };
                // Rounding of sums over 16 points.
                let off = [place - passage.distance, end - passage.speed, squared - passage.squared];
                assert!(off.iter().all(|off| off.abs() < 1e-14), "{damping} {speed} {off:?}");
                // The series ends before where damping is strong.
                assert!(
                    damping > 1.0 || (passage.distance == length) != (passage.speed == 0.0),
                    "{passage:?}"
                );
            }
        }
    }

    #[test]
    fn a_body_runs_on_where_nothing_resists() {
        let passage = Body { mass: 1.0, damping: 0.0 }.passage(1.0, 0.0, 0.0, 3.0);
        assert_eq!((passage.time, passage.distance, passage.speed), (3.0, 3.0, 1.0));
    }
}
