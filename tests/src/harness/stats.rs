//! Statistics by which random results are judged. Each test has a stated rate of false alarms: a correct program fails it
//! for that share of seeds.

/// The rate of false alarms of a whole family of tests.
pub const FAMILY: f64 = 0.01;

/// The rate for each of `n` independent tests such that the family's is `family` (Šidák 1967).
pub fn sidak(family: f64, n: usize) -> f64 {
    -f64::exp_m1(f64::ln_1p(-family) / n as f64)
}

/// Mean of a sample and the standard error of it.
pub fn mean(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
    for x in values {
        n += 1.0;
        let off = x - mean;
        mean += off / n;
        squares += off * (x - mean);
    }
    (mean, (squares / (n * (n - 1.0))).sqrt())
}

/// Probability that χ² of `freedom` degrees is at least `x`.
pub fn chi2_tail(x: f64, freedom: usize) -> f64 {
    gamma_tail(freedom as f64 / 2.0, x / 2.0)
}

/// The regularised upper incomplete gamma function Q(a, x) for a > 0, x ≥ 0: by its series below a + 1, by its continued
/// fraction above (Abramowitz & Stegun 1964, 6.5.29 and 6.5.31).
fn gamma_tail(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-16 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - front * sum;
    }
    // Lentz's evaluation of the fraction.
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (f64::INFINITY, 1.0 / b);
    let mut fraction = d;
    for n in 1..10_000 {
        let k = f64::from(n);
        let numerator = -k * (k - a);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * fraction
}

/// ln Γ(a) for a > 0: Stirling's series (Abramowitz & Stegun 1964, 6.1.40), after a step up to where 5 terms give 1e-14.
fn ln_gamma(a: f64) -> f64 {
    let (mut x, mut product) = (a, 1.0);
    while x < 15.0 {
        product *= x;
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    let series = (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y * (1.0 / 1680.0 - y / 1188.0)))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series - f64::ln(product)
}

/// Probability that a standard normal number is at least |z| away from 0, on either side.
pub fn normal_tails(z: f64) -> f64 {
    chi2_tail(z * z, 1)
}

/// Probability that a standard normal number is at least z.
pub fn normal_upper(z: f64) -> f64 {
    let half = normal_tails(z) / 2.0;
    if z < 0.0 { 1.0 - half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_those_of_the_tables() {
        // Critical values of χ² at 5 % and 1 % (Abramowitz & Stegun 1964, table 26.8), and the exact e^(-x/2) of 2 degrees.
        for (x, freedom, p) in [(3.841_459, 1, 0.05), (18.307_04, 10, 0.05), (135.806_7, 100, 0.01)] {
            assert!((chi2_tail(x, freedom) - p).abs() < 1e-6, "{x} {freedom}: {}", chi2_tail(x, freedom));
        }
        for x in [0.01, 1.0, 3.9, 4.1, 50.0, 700.0] {
            assert!((chi2_tail(x, 2) / (-x / 2.0).exp() - 1.0).abs() < 1e-12, "{x}");
        }
        assert!((normal_tails(1.959_964) - 0.05).abs() < 1e-7);
    }

    #[test]
    fn means_and_families() {
        let (m, e) = mean([1.0, 2.0, 3.0, 4.0]);
        assert!((m - 2.5).abs() < 1e-15 && (e - (5.0f64 / 12.0).sqrt()).abs() < 1e-15);
        assert!((1.0 - (1.0 - sidak(0.01, 50)).powi(50) - 0.01).abs() < 1e-15);
    }
}
