//! Pictures of the route experiment: KUZ figures 2 to 4, an example, and other coefficients.

use super::{Arrivals, Coefficient, Example, Land, Loss, Means, Point, Report, SHOWN, ticks};
use libm::log;
use staya_controller::grid::Cell;
use staya_plot::canvas::{Anchor, Canvas, Pixels, Shape, Stroke, Text};
use staya_plot::colour::{INK, MUTED, PALETTE, WHITE};
use staya_plot::terrain::render;
use staya_plot::{Chart, Panels, Series};
use staya_sim::record::Error;
use std::path::{Path, PathBuf};

impl Report {
    /// Draws all pictures into `dir`, each as SVG and PNG, and returns the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn draw(&self, example: &Example, dir: &Path) -> Result<Vec<PathBuf>, Error> {
        let (losses, times, way) = if self.is_natural() {
            ("figure3", "figure4b", "example-natural")
        } else {
            ("figure2", "figure4a", "example-uniform")
        };
        let mut files = self.losses().write(&dir.join(losses))?;
        if let Some(arrivals) = self.arrivals() {
            files.extend(arrivals.write(&dir.join(times))?);
        }
        files.extend(map(example).write(&dir.join(way))?);
        for coefficient in [Coefficient::A0, Coefficient::A1, Coefficient::A2, Coefficient::A3] {
            if let Some(panels) = self.answers(coefficient) {
                let name = format!("sweep-{}", coefficient.name());
                files.extend(panels.write(&dir.join(name))?);
            }
        }
        Ok(files)
    }

    fn is_natural(&self) -> bool {
        self.points.iter().all(|point| point.land == "natural")
    }

    fn losses(&self) -> Panels {
        let (title, label) = if self.is_natural() {
            ("Routes by window on natural land", "obstacles N")
        } else {
            ("Routes by window on uniformly random land", "obstacles N of natural land with the same classes")
        };
        let mut note = format!(
            "{0} x {0} cells, window radius {1}, {2} runs each, mean with 95 % interval",
            self.size, self.radius, self.runs
        );
        if let Some(equal) = self.points.iter().find(|p| p.obstacles.is_none()) {
            let place = place(equal);
            note.push_str(&format!("; at N(S) = {place:.0}: all classes equally likely"));
        }
        let percent = |loss: fn(&Point) -> Option<Loss>, equal: bool| {
            let points = self.ordered(equal).into_iter();
            points.filter_map(move |point| {
                let Loss { summary, interval95: [low, high] } = loss(point)?;
                Some([place(point), summary.mean, low, high])
            })
        };
        let mut loss = Chart::new("Loss against the fastest route", label, "loss (%)").note(note);
        type Kind = (&'static str, fn(&Point) -> Option<Loss>);
        let kinds: [Kind; 2] =
            [("time dT", |point| point.time_loss_percent), ("length dL", |point| point.length_loss_percent)];
        for (name, value) in kinds {
            loss = loss
                .with(Series::intervals(name, percent(value, false)).joined())
                .with(Series::intervals("", percent(value, true)).like_previous());
        }
        let metric = |name: &str, value: fn(&Point) -> f64| {
            [(name, false), ("", true)].map(|(name, equal)| {
                let points = self.ordered(equal).into_iter();
                Series::points(name, points.map(|point| [place(point), value(point)]))
            })
        };
        let [of_n, of_equal] = metric("landscapes", |point| point.entropy);
        let entropy = Chart::new("Configuration entropy", label, "S")
            .size(720.0, 320.0)
            .with(of_n.joined())
            .with(of_equal.like_previous())
            .with(Series::reference(
                "N(S) of the paper, corrected: S = ln(N / 0.0160518) / 4.22769",
                self.entropy_by_formula(),
            ));
        let [of_n, of_equal] = metric("", |point| point.total_edge_density);
        let edges = Chart::new("Total edge density", label, "TED (sides per cell)")
            .size(720.0, 320.0)
            .with(of_n.joined())
            .with(of_equal.like_previous());
        Panels::new(title).with(loss).with(entropy).with(edges)
    }

    fn ordered(&self, equal: bool) -> Vec<&Point> {
        let wanted = |point: &&Point| point.obstacles.is_none() == equal;
        let mut points: Vec<&Point> = self.points.iter().filter(wanted).collect();
        points.sort_by(|a, b| place(a).total_cmp(&place(b)));
        points
    }

    fn entropy_by_formula(&self) -> Vec<[f64; 2]> {
        let places = || self.points.iter().map(place);
        let (low, high) =
            places().fold((f64::INFINITY, 1.0), |(low, high), x| (low.min(x.max(1.0)), f64::max(high, x)));
        let zero = staya_sim::terrain::metrics::obstacles_of_entropy(0.0);
        (0..=60).map(|i| low + (high - low) * f64::from(i) / 60.0).map(|n| [n, log(n / zero) / 4.227_69]).collect()
    }

    fn arrivals(&self) -> Option<Panels> {
        let off = |point: &&Point| point.obstacles.map_or(u32::MAX, |n| n.abs_diff(SHOWN));
        let point = self.points.iter().min_by_key(off)?;
        let (ours, best) = (point.arrivals.as_ref()?, point.optimal_arrivals.as_ref()?);
        let land = match point.obstacles {
            Some(obstacles) => format!("{} land, N = {obstacles}", point.land),
            None => String::from("uniform land"),
        };
        let panels = Panels::new(format!("Times of arrival, {land}"))
            .columns(2)
            .with(histogram("Fastest route", best))
            .with(histogram("Route by window", ours));
        Some(panels)
    }

    fn answers(&self, coefficient: Coefficient) -> Option<Panels> {
        let answers: Vec<_> = self.sweep.iter().filter(|answer| answer.coefficient == coefficient).collect();
        if answers.is_empty() {
            return None;
        }
        // The axis includes all values, even if losses exceed the chart.
        let own = match coefficient {
            Coefficient::A0 => self.a0,
            Coefficient::A1 => self.a1,
            Coefficient::A2 => self.a2,
            Coefficient::A3 => self.a3,
        };
        let values = answers.iter().map(|answer| answer.value);
        let (low, high) = values.fold((own, own), |(a, b), x| (a.min(x), b.max(x)));
        let room = ((high - low) * 0.02).max(0.1);
        type Measure = (fn(&Point) -> Option<Loss>, fn(&Means) -> Option<f64>);
        let chart = |title: &str, label: &str, (own_loss, value): Measure| {
            let losses = self.points.iter().filter_map(own_loss);
            let roof = 3.0 * losses.map(|loss| loss.summary.mean).fold(1.0, f64::max);
            let mut chart = Chart::new(title, coefficient.name(), label)
                .size(560.0, 420.0)
                .x_range(low - room, high + room)
                .y_range(0.0, roof)
                .with(Series::reference("in use", [[own, 0.0], [own, roof]]));
            for (index, point) in self.points.iter().enumerate() {
                let name = match point.obstacles {
                    Some(n) => format!("N = {n}"),
                    None => String::from("equal classes"),
                };
                let mut line: Vec<[f64; 2]> =
                    answers.iter().filter_map(|answer| Some([answer.value, value(&answer.points[index])?])).collect();
                line.sort_by(|a, b| a[0].total_cmp(&b[0]));
                chart = chart.with(Series::points(name, line).joined());
            }
            chart
        };
        let land = if self.is_natural() { "natural" } else { "uniformly random" };
        let title = format!("What {} does on {land} land", coefficient.name());
        let time: Measure = (|p| p.time_loss_percent, |m| m.time_loss_percent);
        let length: Measure = (|p| p.length_loss_percent, |m| m.length_loss_percent);
        let time = chart("Mean time loss dT", "dT (%)", time);
        let length = chart("Mean length loss dL", "dL (%)", length);
        Some(Panels::new(title).columns(2).with(time).with(length))
    }
}

fn place(point: &Point) -> f64 {
    point.obstacles.map_or(point.obstacles_of_entropy, f64::from)
}

fn histogram(title: &str, arrivals: &Arrivals) -> Chart {
    let edge = |bin: usize| arrivals.low_ticks + bin as f64 * arrivals.bin_ticks;
    let total: u64 = arrivals.counts.iter().sum();
    let bars = arrivals.counts.iter().enumerate();
    let bars = bars.map(|(bin, &count)| [edge(bin), edge(bin + 1), count as f64]);
    let mut chart =
        Chart::new(title, "travel time (ticks)", "runs").size(560.0, 400.0).with(Series::bars("runs", bars));
    if let Some(law) = arrivals.norton_rice {
        let last = edge(arrivals.counts.len());
        let area = total as f64 * arrivals.bin_ticks;
        let curve = (0..=200).map(|i| {
            let x = arrivals.low_ticks + (last - arrivals.low_ticks) * f64::from(i) / 200.0;
            [x, area * law.pdf(x)]
        });
        chart = chart.with(Series::line("Norton-Rice law", curve));
    }
    if let Some(test) = arrivals.goodness {
        let (chi2, freedom) = (test.chi2, test.freedom);
        chart = chart.note(format!("chi-square {chi2:.1} with {freedom} degrees of freedom, p = {:.3}", test.p_value));
    }
    chart
}

fn map(example: &Example) -> Canvas {
    const SIDE: f64 = 700.0;
    const LEFT: f64 = 20.0;
    const TOP: f64 = 112.0;
    let title = "A robot's way by window and the fastest route";
    let mut canvas = Canvas::new(SIDE + 2.0 * LEFT, SIDE + TOP + LEFT, title);
    canvas.text(Text { bold: true, ..Text::new([LEFT, 30.0], 18.0, Anchor::Start, title) });
    let land = match example.family {
        Land::Natural(n) => format!("Natural land, N = {n}"),
        Land::Shuffled(n) => format!("The cells of natural land, N = {n}, shuffled"),
        Land::Uniform => String::from("Land with all classes equally likely"),
    };
    let dots = if example.parked.is_empty() { "" } else { "; dots: other robots" };
    let note = format!("{land}; darker is slower. The run with the median time loss. Square: the robot's window{dots}");
    canvas.text(Text { colour: MUTED, ..Text::new([LEFT, 50.0], 11.5, Anchor::Start, note) });

    let (width, height, grey) = render(&example.land, 1);
    let rgba = grey.into_iter().map(|g| [g, g, g, 255]).collect();
    let area = [LEFT, TOP, SIDE, SIDE];
    let pixels = Pixels { width, height, rgba };
    canvas.shapes.push(Shape::Image { area, pixels });
    canvas.rectangle(area, None, Some(Stroke::new(MUTED, 1.0)));
    let cell = SIDE / f64::from(height.max(1));
    let centre = |c: &Cell| {
        let (x, y) = (f64::from(c.x) + 0.5, f64::from(c.y) + 0.5);
        [LEFT + x * cell, TOP + SIDE - y * cell]
    };

    // Thinner, so that both paths are visible where they coincide.
    let (thick, thin) = (Stroke::new(PALETTE[0], 6.0), Stroke::new(PALETTE[1], 2.0));
    for (way, stroke) in [(&example.optimal, thick), (&example.way, thin)] {
        let points: Vec<[f64; 2]> = way.iter().map(centre).collect();
        canvas.line(points.clone(), Stroke::new(WHITE, stroke.width + 2.5));
        canvas.line(points, stroke);
    }
    for at in example.optimal.first().into_iter().chain(example.optimal.last()) {
        canvas.circle(centre(at), 5.0, Some(WHITE), Some(Stroke::new(INK, 2.0)));
    }
    for at in &example.parked {
        canvas.circle(centre(at), cell * 0.4, Some(PALETTE[2]), None);
    }
    if let Some(halfway) = example.way.get(example.way.len() / 2) {
        let ([x, y], half) = (centre(halfway), (f64::from(example.radius) + 0.5) * cell);
        let square = [x - half, y - half, 2.0 * half, 2.0 * half];
        canvas.clip(Some(area));
        canvas.rectangle(square, None, Some(Stroke::new(PALETTE[1], 1.5)));
        canvas.clip(None);
        canvas.circle([x, y], 4.0, Some(PALETTE[1]), Some(Stroke::new(WHITE, 1.5)));
    }

    let run = &example.run;
    let walk = run.walks.first().copied().unwrap_or_default();
    let lost = if walk.arrived { "" } else { ", not arrived" };
    let numbers = |cost, length| {
        let (ticks, cells) = (ticks(cost), ticks(length));
        format!("{ticks:.0} ticks, {cells:.1} cells long")
    };
    let ours = numbers(walk.cost, walk.length);
    let best = numbers(run.optimal_cost, run.optimal_length);
    let rows = [(format!("by window: {ours}{lost}"), thin), (format!("fastest: {best}"), thick)];
    for (row, (text, stroke)) in rows.into_iter().enumerate() {
        let y = 72.0 + 20.0 * row as f64;
        canvas.line(vec![[LEFT + 3.0, y], [LEFT + 28.0, y]], stroke);
        canvas.text(Text::new([LEFT + 38.0, y], 13.0, Anchor::Start, text).centred());
    }
    canvas
}
