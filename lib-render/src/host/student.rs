//! Quantiles of Student's t distribution, for the tests of [`super::compare`].

use std::f64::consts::FRAC_PI_2;

/// The value that |t| exceeds with probability 1 - `inside`, for t of Student's distribution with `nu` degrees of freedom.
///
/// For a whole number of degrees of freedom P(|t| < x) is a finite sum, so no incomplete beta function is needed. The
/// bisection runs in the angle atan(x/sqrt(nu)), where the range is finite; the error is below 1e-12 relative for
/// `inside` up to 0.9999.
///
/// # Panics
/// If `nu` is 0 or `inside` is not in [0, 1).
pub fn two_sided_quantile(nu: u32, inside: f64) -> f64 {
    assert!(nu >= 1 && (0.0..1.0).contains(&inside), "Student's t needs nu >= 1 and a probability below 1");
    let (mut lo, mut hi) = (0.0, FRAC_PI_2);
    // Each step halves an interval of length below 2, so 60 steps reach the resolution of f64.
    for _ in 0..60 {
        let mid = 0.5 * (lo + hi);
        if two_sided_cdf(nu, mid) < inside { lo = mid } else { hi = mid }
    }
    f64::from(nu).sqrt() * hi.tan()
}

/// P(|t| < sqrt(nu)·tan(theta)) for `nu` degrees of freedom (Abramowitz & Stegun 1964, 26.7.3 and 26.7.4).
fn two_sided_cdf(nu: u32, theta: f64) -> f64 {
    let (sin, cos) = theta.sin_cos();
    // Both series have terms c_k·cos^k with c_k/c_(k-2) = (k-1)/k, starting at k = 1 (odd nu) or k = 0 (even nu).
    let mut term = if nu % 2 == 1 { cos } else { 1.0 };
    let mut sum = 0.0;
    let mut k = nu % 2;
    while k + 2 <= nu {
        sum += term;
        k += 2;
        term *= f64::from(k - 1) / f64::from(k) * cos * cos;
    }
    if nu % 2 == 1 { (theta + sin * sum) / FRAC_PI_2 } else { sin * sum }
}

#[cfg(test)]
mod tests {
    use super::two_sided_quantile;

    #[test]
    fn quantiles_agree_with_the_printed_tables() {
        // Abramowitz & Stegun 1964, table 26.10 (three digits after the point), and closed forms for nu = 1 and 2.
        for (nu, inside, t) in
            [(1, 0.99, 63.657), (5, 0.99, 4.032), (15, 0.99, 2.947), (16, 0.95, 2.120), (120, 0.99, 2.617)]
        {
            assert!((two_sided_quantile(nu, inside) - t).abs() < 6e-4, "nu {nu}");
        }
        assert!((two_sided_quantile(1, 0.5) - 1.0).abs() < 1e-12);
        assert!((two_sided_quantile(2, 0.5) - (2.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    }
}
