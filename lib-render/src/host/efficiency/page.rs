//! The report for people: one page that holds all it shows.

use std::fmt::Write;

use super::bootstrap::Interval;
use super::chart::{COLOURS, chart, escaped};
use super::table::{Metric, gain, mean_gain};
use super::{Measurement, Outcome};

/// How the page looks.
const STYLE: &str = "body{font:15px/1.45 sans-serif;color:#222;max-width:66em;margin:2em auto;padding:0 1em}\
table{border-collapse:collapse;margin:.6em 0 1.2em}th,td{padding:.15em .7em;text-align:right;border-bottom:1px solid #ddd}\
th{font-weight:600;vertical-align:bottom}td:first-child,th:first-child{text-align:left}td:nth-child(2),th:nth-child(2){text-align:left}\
.least{color:#777;font-size:85%}.box{display:inline-block;width:.8em;height:.8em;margin-right:.4em}svg{margin-right:1em}";

/// The page. `about` says what was measured, by which command, where and when.
pub fn page(about: &str, measurements: &[Measurement]) -> String {
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Speed against error</title>\n<style>{STYLE}</style>\n\
         <h1>Speed against error</h1>\n"
    );
    about.lines().for_each(|line| put(&mut text, &format!("<p>{}</p>", escaped(line))));
    put(&mut text, EXPLANATION);
    put(&mut text, &summary(measurements));
    measurements.iter().for_each(|m| put(&mut text, &scene(m)));
    text += "</html>\n";
    text
}

/// What the columns mean.
const EXPLANATION: &str = "<p>The clock runs from the opening of the scene's file to the finished film. <b>relMSE</b> is the \
variance of luminance between films of other seeds, relative to the square of the picture (plus a tenth of its mean, squared), \
averaged over pixels; <b>trimmed</b> leaves out the thousandth of the pixels that is worst for all contestants together; \
<b>eps 0.01</b> adds that in place of the tenth; <b>SMAPE</b> is the mean of 2|x − m|/(|x| + |m|). A <b>gain</b> is how many times \
as efficient the first contestant is as the other: 1/(error · seconds), with the interval of 95 % that other seeds would fill. \
<b>Bright</b> is the share of the light in the brightest thousandth of all pixels: who has less of it has not found it. \
<b>Overtaken</b> is when the first contestant has more samples than this one, in seconds from the opening of the file.</p>";

/// The geometric means over scenes, of each contestant against the first.
fn summary(measurements: &[Measurement]) -> String {
    let mut text = String::from("<h2>All scenes</h2>\n");
    let Some(outcomes) = measurements.first().map(|m| &m.outcomes) else { return text };
    let first = &outcomes[0].contestant;
    put(&mut text, &format!("<p>Gain of {} over</p><table>", escaped(first)));
    let heads: String = Metric::ALL.iter().map(|m| format!("<th>{}", m.name())).collect();
    put(&mut text, &format!("<tr><th>contestant<th>budget{heads}<th>least, of the scenes"));
    for (k, outcome) in outcomes.iter().enumerate().filter(|(_, r)| r.contestant != *first) {
        let pairs: Vec<(&Outcome, &Outcome)> =
            measurements.iter().filter_map(|m| Some((against(m, outcome.budget)?, m.outcomes.get(k)?))).collect();
        let cells: String = Metric::ALL.iter().map(|m| format!("<td>{}", interval(mean_gain(&pairs, *m)))).collect();
        let least = pairs.iter().map(|(a, b)| gain(a, b, Metric::Relative).value).fold(f64::INFINITY, f64::min);
        let name = escaped(&outcome.contestant);
        put(&mut text, &format!("<tr><td>{name}<td>{} s{cells}<td>{}", outcome.budget, short(least)));
    }
    text + "</table>\n"
}

/// The first contestant of a budget.
fn against(measurement: &Measurement, budget: f64) -> Option<&Outcome> {
    measurement.outcomes.iter().find(|r| r.budget == budget)
}

/// A scene: a table, and error over time.
fn scene(measurement: &Measurement) -> String {
    let Measurement { scene, size: [width, height], outcomes } = measurement;
    let mut text = format!("<h2>{}</h2>\n<p>{width} × {height} pixels</p><table>\n", escaped(scene));
    put(
        &mut text,
        "<tr><th>contestant<th>budget<th>spp<th>s<th>of that<br>rendering<th>relMSE<th>trimmed<th>eps 0.01<th>SMAPE\
         <th>gain of the first<th>trimmed<th>bright<th>overtaken",
    );
    let mut names: Vec<&str> = Vec::new();
    for outcome in outcomes {
        let first = against(measurement, outcome.budget).expect("a budget has outcomes");
        if !names.contains(&outcome.contestant.as_str()) {
            names.push(&outcome.contestant);
        }
        put(&mut text, &row(outcome, first, &names));
    }
    text += "</table>\n";
    let lines = |time: fn(&Outcome) -> f64| -> Vec<Vec<[f64; 2]>> {
        let points = |name: &&str| {
            let of = outcomes.iter().filter(|r| r.contestant == **name);
            of.map(|r| [time(r), Metric::Relative.of(&r.runs)]).collect()
        };
        names.iter().map(points).collect()
    };
    let whole = lines(|r| r.mean(|run| run.seconds));
    let rendering = lines(|r| r.mean(|run| run.render_seconds));
    text += &chart("From the opening of the file", "seconds", "relMSE", &whole);
    text + &chart("Rendering alone", "seconds", "relMSE", &rendering)
}

/// A line of a scene's table.
fn row(outcome: &Outcome, first: &Outcome, names: &[&str]) -> String {
    let colour = COLOURS[names.iter().position(|n| *n == outcome.contestant).unwrap_or(0) % COLOURS.len()];
    let name = format!("<span class=\"box\" style=\"background:{colour}\"></span>{}", escaped(&outcome.contestant));
    let [relative, trimmed, public] =
        [Metric::Relative, Metric::Trimmed, Metric::Public].map(|m| short(m.of(&outcome.runs)));
    let smape = short(outcome.mean(|run| run.errors.smape));
    let [seconds, rendering] = [short(outcome.mean(|r| r.seconds)), short(outcome.mean(|r| r.render_seconds))];
    let (gains, overtaken) = if outcome.contestant == first.contestant {
        (["".into(), "".into()], String::new())
    } else {
        let gains = [Metric::Relative, Metric::Trimmed].map(|m| interval(gain(first, outcome, m)));
        (gains, first.overtakes(outcome).map_or("never".into(), |s| format!("{} s", short(s))))
    };
    format!(
        "<tr><td>{name}<td>{} s<td>{}<td>{seconds}<td>{rendering}<td>{relative}<td>{trimmed}<td>{public}<td>{smape}<td>{}<td>{}\
         <td>{:.2} %<td>{overtaken}",
        outcome.budget,
        outcome.spp,
        gains[0],
        gains[1],
        100.0 * outcome.bright
    )
}

fn interval(Interval { value, least, most }: Interval) -> String {
    format!("{} <span class=\"least\">[{}, {}]</span>", short(value), short(least), short(most))
}

/// A number in three digits.
fn short(x: f64) -> String {
    if x != 0.0 && x.is_finite() && !(1e-2..1e5).contains(&x.abs()) {
        return format!("{x:.2e}");
    }
    crate::host::figures::plot::short(x)
}

fn put(text: &mut String, line: &str) {
    writeln!(text, "{line}").expect("a string takes it");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::efficiency::Measured;
    use crate::host::efficiency::score::Errors;

    #[test]
    fn the_page_holds_every_contestant_and_the_gain_over_each() {
        let outcome = |name: &str, error: f64| {
            let errors = Errors { relative: error, trimmed: error, public: error, smape: error.sqrt() };
            let run = |seed| Measured { seed, seconds: 2.0, render_seconds: 1.0, errors };
            Outcome { contestant: name.into(), budget: 2.0, spp: 8, runs: vec![run(0), run(1)], bright: 0.01 }
        };
        let outcomes = vec![outcome("ours", 0.1), outcome("<theirs>", 0.25)];
        let text = page("here & now", &[Measurement { scene: "s".into(), size: [3, 2], outcomes }]);
        assert!(text.contains("here &amp; now") && text.contains("&lt;theirs&gt;"));
        // The gain stands in the summary four times, once for each metric, and twice beside the contestant.
        assert_eq!(text.matches("2.5 <span class=\"least\">[2.5, 2.5]</span>").count(), 6);
        assert_eq!(text.matches("<svg").count(), 2);
    }
}
