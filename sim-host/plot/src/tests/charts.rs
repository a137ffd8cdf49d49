use super::{assert_readable, assert_texts_apart, assert_well_formed, decode, text_boxes};
use crate::canvas::{Canvas, Pixels, Point, Shape};
use crate::colour::{self, PALETTE};
use crate::{Chart, Panels, Series, svg};
use proptest::prelude::*;

fn full() -> Chart {
    let xs = || (1..=6).map(f64::from);
    let chart = Chart::new("Loss & <gain>", "obstacles", "ΔT (%)");
    Chart { note: "mean and 95 % interval".into(), ..chart }
        .with(Series::bars("counts", xs().map(|x| [x, x + 1.0, x * 2.0])))
        .with(Series::intervals("natural", xs().map(|x| [x, x, x - 0.5, x + 0.5])).joined())
        .with(Series::line("fit", xs().map(|x| [x, x * 1.1])).dashed())
        .with(Series::points("runs", xs().map(|x| [x, 9.0 - x])))
        .with(Series::reference("paper", [[1.0, 4.0], [6.0, 4.0]]))
}

fn svg_of(chart: &Chart) -> String {
    svg::text(&chart.draw()).unwrap()
}

fn drawn(canvas: &Canvas) -> Vec<Point> {
    let points = |shape: &Shape| match shape {
        Shape::Path { lines, .. } => lines.concat(),
        Shape::Circle { centre, .. } => vec![*centre],
        _ => Vec::new(),
    };
    canvas.shapes.iter().flat_map(points).collect()
}

#[test]
fn names_stand_below_their_values_in_one_row_or_two() {
    for (count, rows) in [(3, 1), (12, 2)] {
        let names: Vec<String> = (0..count).map(|at| format!("scenario-{at}")).collect();
        let marks = (1..=count).map(|at| [f64::from(at), 1.0]);
        let canvas = Chart::new("Loss", "scenario", "loss").with(Series::points("", marks)).names(names.clone()).draw();
        assert_texts_apart(&canvas);
        let boxes = text_boxes(&canvas);
        let mut bottoms: Vec<_> =
            boxes.iter().filter(|(text, _)| names.contains(text)).map(|(_, area)| area[3]).collect();
        assert_eq!(bottoms.len(), names.len());
        bottoms.dedup();
        assert_eq!(bottoms.len(), if rows == 1 { 1 } else { names.len() }, "{bottoms:?}");
    }
}

#[test]
fn counts_have_whole_numbers() {
    let chart =
        Chart::new("Arrivals", "ticks", "runs").with(Series::bars("runs", [[0.0, 10.0, 3.0], [10.0, 20.0, 1.0]]));
    let texts = text_boxes(&chart.draw());
    let shown = |text: &str| texts.iter().any(|(shown, _)| shown == text);
    assert!(["1", "2", "3"].into_iter().all(shown) && !["0.5", "1.0"].into_iter().any(shown), "{texts:?}");
}

#[test]
fn both_files_are_readable_and_reproducible() {
    let dir = tempfile::tempdir().unwrap();
    let stem = dir.path().join("new/loss-0.3");
    let files = full().draw().write(&stem).unwrap();
    let names: Vec<_> = files.iter().map(|path| path.file_name().unwrap()).collect();
    assert_eq!(names, ["loss-0.3.svg", "loss-0.3.png"]);
    assert_readable(&files);
    let bytes: Vec<_> = files.iter().map(|path| std::fs::read(path).unwrap()).collect();
    full().draw().write(&stem).unwrap();
    for (path, before) in files.iter().zip(bytes) {
        assert_eq!(std::fs::read(path).unwrap(), before);
    }
    let left: Vec<_> = std::fs::read_dir(stem.parent().unwrap()).unwrap().collect();
    assert_eq!(left.len(), 2, "no temporary files remain");
}

#[test]
fn png_has_two_pixels_per_unit_on_white() {
    let dir = tempfile::tempdir().unwrap();
    let files = full().size(300.0, 200.0).draw().write(&dir.path().join("a")).unwrap();
    let (width, height, bytes) = decode(&files[1]);
    assert_eq!((width, height), (600, 400));
    assert_eq!(bytes[..3], [255; 3]);
    let has = |colour: colour::Colour| bytes.chunks(3).any(|pixel| pixel == colour.rgb);
    assert!(has(PALETTE[1]) && has(PALETTE[2]), "lines in the palette's colours");
}

#[test]
fn text_stays_text_in_the_svg() {
    let text = svg_of(&full());
    assert!(text.contains("font-family=\"sans-serif\""));
    for part in
        [">Loss &amp; &lt;gain&gt;<", ">obstacles<", ">ΔT (%)<", ">natural<", ">paper<", ">mean and 95 % interval<"]
    {
        assert!(text.contains(part), "{part}");
    }
    assert!(text.contains("stroke-dasharray"));
    assert!(text.contains("font-weight=\"bold\""));
    assert!(!text.contains("<!--"));
}

#[test]
fn an_unwritable_path_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    std::fs::write(&file, "").unwrap();
    let error = full().draw().write(&file.join("chart")).unwrap_err();
    assert_eq!(error.path(), file);
    std::fs::create_dir(dir.path().join("b.png")).unwrap();
    let error = full().draw().write(&dir.path().join("b")).unwrap_err();
    assert_eq!(error.path(), dir.path().join("b.png"));
    assert!(error.to_string().contains("b.png"), "{error}");
}

#[test]
fn charts_without_data_show_a_note() {
    let none: [[f64; 2]; 0] = [];
    for chart in [
        Chart::new("", "", ""),
        Chart::new("t", "x", "y").with(Series::line("a", none)),
        Chart::new("t", "x", "y").with(Series::points("a", [[f64::NAN, 1.0], [1.0, f64::INFINITY]])),
        Chart { log_x: true, ..Chart::new("t", "x", "y") }.with(Series::points("a", [[0.0, 1.0], [-3.0, 1.0]])),
        Chart { log_y: true, ..Chart::new("t", "x", "y") }.with(Series::points("a", [[1.0, 0.0], [1.0, -3.0]])),
    ] {
        assert!(svg_of(&chart).contains(">no data<"));
        assert_texts_apart(&chart.draw());
    }
    assert!(!svg_of(&full()).contains("no data"));
}

#[test]
fn decades_have_equal_lengths_on_a_logarithmic_axis() {
    let decades = [[1.0, 0.1], [10.0, 10.0], [100.0, 1000.0], [1000.0, 0.0]];
    let chart = Chart::new("t", "x", "y").with(Series::line("a", decades));
    let both = Chart { log_x: true, log_y: true, ..chart.clone() };
    let line = |chart: &Chart| -> Vec<[f64; 2]> {
        let shapes = chart.draw().shapes;
        let line = shapes.iter().rev().find_map(|shape| match shape {
            Shape::Path { lines, .. } => lines.iter().find(|line| line.len() > 2).cloned(),
            _ => None,
        });
        line.expect("a line")
    };
    let [a, b, c] = line(&both)[..] else {
        panic!("values not above 0 are skipped");
    };
    assert!((b[0] - a[0] - (c[0] - b[0])).abs() < 1e-9);
    assert!((b[1] - a[1] - (c[1] - b[1])).abs() < 1e-9);
    assert_eq!(line(&chart).len(), 4);
}

#[test]
fn undefined_values_are_gaps() {
    let points = [[0.0, 1.0], [1.0, 2.0], [2.0, f64::NAN], [3.0, 2.0], [4.0, 1.0]];
    let chart = Chart::new("", "", "").with(Series::line("", points).colour(PALETTE[5]));
    let lines = chart.draw().shapes.into_iter().find_map(|shape| match shape {
        Shape::Path { lines, stroke: Some(stroke), .. } if stroke.colour == PALETTE[5] => Some(lines),
        _ => None,
    });
    let lengths: Vec<usize> = lines.unwrap().iter().map(Vec::len).collect();
    assert_eq!(lengths, [2, 2]);
}

#[test]
fn a_single_value_is_in_the_middle_and_zero_at_the_bottom() {
    let mark = |y: f64| {
        let chart = Chart::new("", "", "").with(Series::points("", [[5.0, y]]));
        let canvas = chart.draw();
        let circle = canvas.shapes.iter().find_map(|shape| match shape {
            Shape::Circle { centre, .. } => Some(*centre),
            _ => None,
        });
        circle.unwrap()
    };
    let [x, y] = mark(7.0);
    assert!(x > 300.0 && x < 450.0 && y > 100.0 && y < 300.0, "{x} {y}");
    assert!(mark(0.0)[1] > 300.0);
}

#[test]
fn valid_ranges_apply_and_invalid_ones_are_ignored() {
    let all = Chart::new("", "", "").with(Series::line("", [[0.0, 0.0], [10.0, 100.0]]));
    let part = |low, high| Chart { x_range: Some([low, high]), ..all.clone() };
    assert!(!svg_of(&part(0.0, 5.0).with(Series::points("", [[1.0, 3.0]]))).contains(">100<"));
    for (low, high) in [(5.0, 5.0), (7.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        assert_eq!(svg_of(&part(low, high)), svg_of(&all), "{low} {high}");
    }
}

#[test]
fn many_points_are_thinned_but_extremes_stay() {
    let wave = (0..500_000).map(|i| {
        let spike = if i == 250_001 { 9.0 } else { 0.0 };
        [f64::from(i), libm::sin(f64::from(i)) + spike]
    });
    let chart = Chart::new("", "", "").with(Series::line("", wave));
    let canvas = chart.draw();
    assert!(drawn(&canvas).len() < 5000);
    let line = canvas.shapes.iter().find_map(|shape| match shape {
        Shape::Path { lines, stroke: Some(stroke), .. } if stroke.colour == PALETTE[0] => Some(&lines[0]),
        _ => None,
    });
    let by_height = |a: &&Point, b: &&Point| a[1].total_cmp(&b[1]);
    let mut ys: Vec<&Point> = line.unwrap().iter().collect();
    ys.sort_by(by_height);
    assert!(ys[1][1] - ys[0][1] > 100.0, "{:?}", &ys[..2]);
    let cloud = (0..200_000).map(|i| [f64::from(i % 447), f64::from(i / 447)]);
    let canvas = Chart::new("", "", "").with(Series::points("", cloud.chain([[0.0, 0.0]]))).draw();
    assert!(canvas.shapes.len() < 200_050);
}

#[test]
fn series_have_different_colours_and_references_are_grey() {
    let text = svg_of(&full());
    let hex = |index: usize| {
        let [r, g, b] = PALETTE[index].rgb;
        format!("#{r:02x}{g:02x}{b:02x}")
    };
    assert!((0..4).all(|index| text.contains(&hex(index))));
    assert!(!text.contains(&hex(4)), "the reference is grey and takes no colour");
    for (i, a) in PALETTE.iter().enumerate() {
        assert!(PALETTE[i + 1..].iter().all(|b| a.rgb != b.rgb));
    }
}

#[test]
fn panels_align_their_axes_and_keep_texts_apart() {
    let narrow = Chart::new("One", "x", "y").with(Series::line("", [[0.0, 0.0], [1.0, 1.0]]));
    let wide = Chart::new("Two", "x", "y").with(Series::line("", [[0.0, 0.0], [1.0, 0.00123]]));
    let axes = |canvas: &Canvas| -> Vec<f64> {
        let is_axis = |shape: &Shape| match shape {
            Shape::Path { lines, closed: false, stroke: Some(stroke), .. }
                if stroke.colour == colour::INK && lines[0].len() == 3 =>
            {
                Some(lines[0][0][0])
            }
            _ => None,
        };
        canvas.shapes.iter().filter_map(is_axis).collect()
    };
    let (a, b) = (axes(&narrow.draw())[0], axes(&wide.draw())[0]);
    assert!(a < b, "wide numbers need room");
    let both = Panels::new("Both").with(narrow.clone()).with(wide.clone()).draw();
    assert_eq!(axes(&both), [b, b]);
    assert_texts_apart(&both);
    let beside = Panels::new("").columns(2).with(narrow).with(wide).with(full()).draw();
    assert_eq!((beside.width, beside.height), (1440.0, 840.0));
    assert_texts_apart(&beside);
    let none = Panels::new("").draw();
    assert!(none.width > 0.0 && none.height > 0.0);
}

#[test]
fn strange_text_keeps_the_file_well_formed() {
    let name = "a<b>&\"c\"\u{0}\u{8}\n\u{ffff}∑日";
    let chart = Chart { note: name.into(), ..Chart::new(name, name, name) };
    let chart = chart.with(Series::points(name, [[0.0, 0.0]]));
    assert_well_formed(&svg_of(&chart));
    assert!(crate::raster::png(&chart.draw()).is_ok());
}

#[test]
fn long_numbers_at_the_ends_of_an_axis_stay_inside() {
    let low = -213.928_431;
    for width in [300.0, 657.7, 720.0] {
        let line = Series::line("A", [[low, -1.0], [low + 1e-6, 1.0]]);
        let chart = Chart::new("t", "x", "y").size(width, 420.0).with(line);
        assert_texts_apart(&chart.draw());
    }
}

#[test]
fn sizes_stay_within_bounds() {
    for (width, height) in [(0.0, -5.0), (f64::NAN, f64::NAN), (1e9, f64::INFINITY)] {
        let canvas = full().size(width, height).draw();
        assert!((200.0..=4000.0).contains(&canvas.width), "{width}");
        assert!((150.0..=4000.0).contains(&canvas.height), "{height}");
    }
    let canvas = Canvas::new(1e9, 1e9, "too large");
    let dir = tempfile::tempdir().unwrap();
    let message = canvas.write(&dir.path().join("big")).unwrap_err().to_string();
    assert!(message.contains("big.png"), "{message}");
    assert!(std::fs::read_dir(dir.path()).unwrap().next().is_none());
}

#[test]
fn images_keep_their_pixels_and_clips_apply() {
    let dir = tempfile::tempdir().unwrap();
    let mut canvas = Canvas::new(8.0, 4.0, "");
    canvas.clip(Some([0.0, 0.0, 6.0, 4.0]));
    let rgba = vec![[255, 0, 0, 255], [0, 0, 255, 0]];
    let pixels = Pixels { width: 2, height: 1, rgba };
    canvas.shapes.push(Shape::Image { area: [0.0, 0.0, 4.0, 4.0], pixels });
    canvas.rectangle([4.0, 0.0, 4.0, 4.0], Some(PALETTE[2]), None);
    canvas.clip(None);
    let files = canvas.write(&dir.path().join("p")).unwrap();
    assert_readable(&files);
    let (width, _, bytes) = decode(&files[1]);
    let row: Vec<&[u8]> = bytes.chunks(3).take(width as usize).collect();
    assert_eq!(row[0..4], [&[255, 0, 0]; 4]);
    assert_eq!(row[4..8], [&[255; 3]; 4], "clear pixels show the ground");
    assert_eq!(row[8..12], [&PALETTE[2].rgb; 4]);
    assert_eq!(row[12..16], [&[255; 3]; 4], "cut off");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn texts_do_not_overlap(
        low in -1e4_f64..1e4,
        exponent in -7_i32..9,
        height in -9.0_f64..9.0,
        width in 300.0_f64..1200.0,
        names in proptest::collection::vec("[a-zA-Z ,.%]{1,40}", 1..7),
        log in any::<[bool; 2]>(),
    ) {
        let span = libm::pow(10.0, exponent.into());
        let tall = libm::pow(10.0, height);
        let mut chart = Chart::new("A title of some length for a chart", "time (s)", "error (cells)")
            .size(width, 420.0);
        for name in names {
            chart = chart.with(Series::line(name, [[low, -tall], [low + span, tall]]));
        }
        [chart.log_x, chart.log_y] = log;
        let canvas = chart.draw();
        assert_texts_apart(&canvas);
        assert_well_formed(&svg::text(&canvas).unwrap());
        for [x, y] in drawn(&canvas) {
            prop_assert!(x >= 0.0 && x <= canvas.width && y >= 0.0 && y <= canvas.height);
        }
    }

    #[test]
    fn any_numbers_can_be_drawn(
        points in proptest::collection::vec(any::<[f64; 4]>(), 0..20),
        log in any::<[bool; 2]>(),
    ) {
        let mut chart = Chart::new("any", "x", "y")
            .size(240.0, 180.0)
            .with(Series::line("line", points.iter().map(|p| [p[0], p[1]])))
            .with(Series::intervals("intervals", points.clone()).joined())
            .with(Series::bars("bars", points.iter().map(|p| [p[0], p[1], p[2]])));
        [chart.log_x, chart.log_y] = log;
        assert_well_formed(&svg_of(&chart));
        prop_assert!(crate::raster::png(&chart.draw()).is_ok());
    }
}
