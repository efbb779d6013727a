//! Error over time as a picture: both axes logarithmic, a line for each contestant, a point for each budget.

use std::fmt::Write;

/// Size of the picture, and of the margins for the axes' words, pixels.
const SIZE: [f64; 2] = [420.0, 300.0];
const LEFT: f64 = 62.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 26.0;
const BOTTOM: f64 = 40.0;
/// Text and axes: 5 : 1 and more against white.
const INK: &str = "#333333";
/// Colours of the lines, told apart by the colour-blind too (Okabe and Ito 2008, "Color Universal Design").
pub const COLOURS: [&str; 7] = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#000000"];

/// Points of a contestant: time and error, both above 0.
pub type Line = Vec<[f64; 2]>;

/// The picture. Points that are not above 0 are left out.
pub fn chart(title: &str, horizontal: &str, vertical: &str, lines: &[Line]) -> String {
    let drawn: Vec<Line> = lines
        .iter()
        .map(|l| l.iter().copied().filter(|p| p.iter().all(|x| *x > 0.0 && x.is_finite())).collect())
        .collect();
    let axes = [0, 1].map(|k| Axis::around(drawn.iter().flatten().map(|p| p[k])));
    let x = |value: f64| LEFT + axes[0].share(value) * (SIZE[0] - LEFT - RIGHT);
    let y = |value: f64| SIZE[1] - BOTTOM - axes[1].share(value) * (SIZE[1] - TOP - BOTTOM);
    let (left, right, top, bottom) = (LEFT, SIZE[0] - RIGHT, TOP, SIZE[1] - BOTTOM);
    let mut body = String::new();
    let mut put = |element: String| writeln!(body, "{element}").expect("a string takes it");
    put(text((left + right) / 2.0, 16.0, "middle", title));
    for tick in axes[0].ticks() {
        put(line([x(tick), top], [x(tick), bottom], "#dddddd"));
        put(text(x(tick), bottom + 15.0, "middle", &tick.to_string()));
    }
    for tick in axes[1].ticks() {
        put(line([left, y(tick)], [right, y(tick)], "#dddddd"));
        put(text(left - 5.0, y(tick) + 4.0, "end", &format!("{tick:e}")));
    }
    put(line([left, bottom], [right, bottom], INK));
    put(line([left, top], [left, bottom], INK));
    put(text((left + right) / 2.0, SIZE[1] - 6.0, "middle", horizontal));
    let turned = format!("transform=\"rotate(-90 12 {0:.1})\" x=\"12\" y=\"{0:.1}\"", (top + bottom) / 2.0);
    put(format!("<text {turned} text-anchor=\"middle\">{}</text>", escaped(vertical)));
    for (points, colour) in drawn.iter().zip(COLOURS.iter().cycle()) {
        let places: Vec<String> = points.iter().map(|[t, e]| format!("{:.1},{:.1}", x(*t), y(*e))).collect();
        put(format!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>",
            places.join(" ")
        ));
        for [t, e] in points {
            put(format!("<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{colour}\"/>", x(*t), y(*e)));
        }
    }
    let [width, height] = SIZE;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\" font-size=\"11\" fill=\"{INK}\">\n{body}</svg>\n"
    )
}

/// A logarithmic axis.
struct Axis {
    least: f64,
    most: f64,
}

impl Axis {
    /// With room around the values; from 1 to 10 if there are none.
    fn around(values: impl Iterator<Item = f64> + Clone) -> Axis {
        let least = values.clone().fold(f64::INFINITY, f64::min);
        let most = values.fold(0.0, f64::max);
        if least > most { Axis { least: 1.0, most: 10.0 } } else { Axis { least: least / 1.5, most: most * 1.5 } }
    }

    /// Where a value is: 0 at the least, 1 at the most.
    fn share(&self, value: f64) -> f64 {
        (value / self.least).ln() / (self.most / self.least).ln()
    }

    /// 1, 2 and 5 times powers of ten; powers alone where the axis spans more than three.
    fn ticks(&self) -> Vec<f64> {
        let digits: &[f64] = if self.most / self.least > 1e3 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let powers = self.least.log10().floor() as i32..=self.most.log10().ceil() as i32;
        // By their decimal text: 2 · 10^-3 computed is not the number nearest to 0.002.
        let tick = |power: i32, digit: &f64| format!("{digit}e{power}").parse::<f64>().unwrap_or(*digit);
        let all = powers.flat_map(|power| digits.iter().map(move |digit| tick(power, digit)));
        all.filter(|tick| (self.least..=self.most).contains(tick)).collect()
    }
}

fn text(x: f64, y: f64, anchor: &str, words: &str) -> String {
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escaped(words))
}

fn line([x1, y1]: [f64; 2], [x2, y2]: [f64; 2], colour: &str) -> String {
    format!("<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\"/>")
}

/// Text within a page.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_round_ticks() {
        assert_eq!(Axis { least: 0.0015, most: 0.03 }.ticks(), [0.002, 0.005, 0.01, 0.02]);
        assert_eq!(Axis { least: 0.5, most: 2e3 }.ticks(), [1.0, 10.0, 100.0, 1000.0]);
    }

    #[test]
    fn every_point_is_within_the_frame() {
        let picture = chart("a < b", "s", "error", &[vec![[1.0, 0.1], [4.0, 0.025]], vec![[0.0, 1.0]], vec![]]);
        assert_eq!(picture.matches("<circle").count(), 2, "a time of 0 is on no logarithmic axis");
        assert!(picture.contains("a &lt; b"));
        let axis = Axis::around([1.0, 4.0].into_iter());
        assert!([1.0, 4.0].iter().all(|v| (0.0..=1.0).contains(&axis.share(*v))));
    }
}
