//! Charts as pictures: scalable vector graphics with horizontal bars, dark on whatever lies behind.

use std::fmt::Write;

use super::{Chart, Group, Spread};

/// Width of the bars, and of what is right of them for values, pixels.
const BARS: f64 = 460.0;
const RIGHT: f64 = 90.0;
/// Width of a letter: 12 pixels high, most are a little narrower.
const LETTER: f64 = 6.8;
/// Height of a line of text, and of a bar.
const LINE: f64 = 18.0;
const BAR: f64 = 12.0;
/// Between groups of bars, and between charts.
const GAP: f64 = 8.0;
const BETWEEN: f64 = 24.0;
/// Text and axes: 5 : 1 and more against white and against light grey.
const INK: &str = "#333333";
/// Colours of the series, told apart by the colour-blind too (Okabe and Ito 2008, "Color Universal Design").
const COLOURS: [&str; 6] = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00"];

/// A picture of these charts, one below the other.
pub fn plot(charts: &[Chart]) -> String {
    let names = charts.iter().flat_map(|c| &c.groups).map(|g| g.name.chars().count());
    let left = (names.max().unwrap_or(0) as f64 * LETTER + 2.0 * GAP).ceil();
    let (mut body, mut y, width) = (String::new(), BETWEEN / 2.0, left + BARS + RIGHT);
    for chart in charts {
        y = Plot { chart, left, body: &mut body }.draw(y) + BETWEEN;
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{y}\" viewBox=\"0 0 {width} {y}\" \
         font-family=\"sans-serif\" font-size=\"12\" fill=\"{INK}\">\n{body}</svg>\n"
    )
}

/// A chart that is being drawn.
struct Plot<'a> {
    chart: &'a Chart,
    /// Where the bars begin.
    left: f64,
    body: &'a mut String,
}

impl Plot<'_> {
    /// Draws it from `y` on. Gives where it ends.
    fn draw(&mut self, y: f64) -> f64 {
        let Plot { chart, left, .. } = *self;
        let (middle, right) = (left + BARS / 2.0, left + BARS);
        self.text(middle, y + LINE, "middle", &format!("{} ({})", chart.title, chart.unit));
        let top = self.legend(y + 1.5 * LINE) + GAP;
        let most = chart.groups.iter().map(|g| self.length(g)).fold(f64::MIN_POSITIVE, f64::max);
        let step = step(most);
        let x = |value: f64| left + value / most * BARS;
        let drawn = || chart.groups.iter().filter(|g| g.bars.iter().any(Option::is_some));
        let bottom = top + drawn().map(|g| self.height(g) + GAP).sum::<f64>();
        for n in 0..=(most / step) as u32 {
            let at = x(f64::from(n) * step);
            self.line([at, top], [at, bottom], 0.25);
            self.text(at, bottom + LINE, "middle", &short(f64::from(n) * step));
        }
        let mut at = top + GAP / 2.0;
        for group in drawn() {
            let height = self.height(group);
            self.text(left - GAP, at + height / 2.0 + 4.0, "end", &group.name);
            if chart.stacked {
                self.stack(group, at, x)
            } else {
                self.side_by_side(group, at, x)
            }
            at += height + GAP;
        }
        self.line([left, top], [left, bottom], 1.0);
        self.line([left, bottom], [right, bottom], 1.0);
        self.text(middle, bottom + 2.0 * LINE, "middle", chart.unit);
        bottom + 2.0 * LINE
    }

    /// A square and a name for each series, in as many lines as it takes.
    fn legend(&mut self, y: f64) -> f64 {
        let (mut x, mut y) = (self.left, y);
        for (name, colour) in self.chart.series.iter().zip(COLOURS.iter().cycle()) {
            let width = 30.0 + LETTER * name.chars().count() as f64;
            if x > self.left && x + width > self.left + BARS + RIGHT {
                (x, y) = (self.left, y + LINE);
            }
            self.rectangle([x, y + 3.0], [BAR, BAR], colour);
            self.text(x + BAR + 5.0, y + 13.0, "start", name);
            x += width;
        }
        y + LINE
    }

    /// How far the bars of a group reach.
    fn length(&self, group: &Group) -> f64 {
        let bars = group.bars.iter().flatten();
        if self.chart.stacked { bars.map(|s| s.median).sum() } else { bars.map(|s| s.most).fold(0.0, f64::max) }
    }

    fn height(&self, group: &Group) -> f64 {
        if self.chart.stacked { BAR + 2.0 } else { (group.bars.iter().flatten().count() as f64 * BAR).max(LINE) }
    }

    /// The parts of a whole, end to end, and its size.
    fn stack(&mut self, group: &Group, y: f64, x: impl Fn(f64) -> f64) {
        let mut sum = 0.0;
        for (bar, colour) in group.bars.iter().zip(COLOURS.iter().cycle()) {
            let part = bar.map_or(0.0, |s| s.median);
            self.rectangle([x(sum), y], [x(sum + part) - x(sum), BAR + 2.0], colour);
            sum += part;
        }
        self.text(x(sum) + 5.0, y + 11.0, "start", &short(sum));
    }

    /// A bar for each series with its value, and a line from the least to the most.
    fn side_by_side(&mut self, group: &Group, mut y: f64, x: impl Fn(f64) -> f64) {
        for (bar, colour) in group.bars.iter().zip(COLOURS.iter().cycle()) {
            let Some(Spread { median, least, most }) = *bar else { continue };
            self.rectangle([x(0.0), y], [x(median) - x(0.0), BAR - 1.0], colour);
            self.line([x(least), y + BAR / 2.0], [x(most), y + BAR / 2.0], 1.0);
            self.text(x(most) + 5.0, y + 10.0, "start", &short(median));
            y += BAR;
        }
    }

    fn text(&mut self, x: f64, y: f64, anchor: &str, text: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        self.put(format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"));
    }

    fn rectangle(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], colour: &str) {
        self.put(format!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{colour}\"/>"
        ));
    }

    fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], width: f64) {
        let ends = format!("x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\"");
        self.put(format!("<line {ends} stroke=\"{INK}\" stroke-width=\"{width}\"/>"));
    }

    fn put(&mut self, element: String) {
        writeln!(self.body, "{element}").expect("a string takes it");
    }
}

/// Between ticks of an axis that reaches so far: 1, 2 or 5 times a power of ten, 4 to 10 times on the axis.
fn step(most: f64) -> f64 {
    let power = 10_f64.powf((most / 10.0).log10().ceil());
    [0.2, 0.5, 1.0].map(|k| k * power).into_iter().find(|step| most / step <= 10.0).unwrap_or(power)
}

/// A number in three digits.
pub fn short(x: f64) -> String {
    let digits = if x == 0.0 || !x.is_finite() { 0 } else { (2 - x.abs().log10().floor() as i32).clamp(0, 9) };
    let text = format!("{x:.*}", digits as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let texts = [0.0, 1.0, 0.012_345, 9.996, 123.4, 12_345.6, 20.0].map(short);
        assert_eq!(texts, ["0", "1", "0.0123", "10", "123", "12346", "20"]);
    }

    #[test]
    fn axes_have_a_few_round_ticks() {
        assert_eq!([7.3, 100.0, 101.0, 0.03].map(step), [1.0, 10.0, 20.0, 0.005]);
    }
}
