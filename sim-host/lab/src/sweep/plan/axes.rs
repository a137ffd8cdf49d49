//! Fields and their values: `axes`, `zip`, `sample` and `set` of a plan.

use super::table::{PlanFile, RangeTable, SampleTable};
use crate::error::SweepError;
use crate::sweep::sample::shares;
use crate::sweep::value::Value;
use staya_sim::scenario::{Field, Location, Node, Read as _, ScenarioError, Source};
use std::ops::Range;
use std::str::FromStr;
use toml::de::{DeTable, DeValue};

/// Name of the axis of several scenarios.
pub const SCENARIO: &str = "scenario";
const MOST: u32 = 1_000_000;

#[derive(Clone, Debug)]
pub struct Axis {
    pub field: Field,
    pub values: Vec<Value>,
    /// Place in the plan; `None` if the values are from the command line.
    pub place: Option<Location>,
    pub is_log: bool,
    /// Values come from a range, which is invalid for text fields.
    pub is_range: bool,
    span: Range<usize>,
}

impl Axis {
    /// Whether the axis is not one of the plan's file.
    pub fn is_added(&self) -> bool {
        self.place.is_none() && self.span == (0..0)
    }
}

/// Fields that a plan varies or sets.
#[derive(Debug, Default)]
pub struct Axes {
    pub axes: Vec<Axis>,
    pub groups: Vec<Range<usize>>,
    /// One value for all runs.
    pub set: Vec<(Field, Value, Range<usize>)>,
}

/// A field's values on the command line, instead of the plan's: `radio.loss=0,0.3`, `count=2..64`.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    field: Field,
    values: Vec<Value>,
}

impl FromStr for Change {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, list) = text.split_once('=').ok_or("give FIELD=VALUE,..., as in radio.loss=0,0.3")?;
        let field = Field::read(name.trim());
        let field = field.ok_or_else(|| format!("{name:?} names no field; give one as in radio.loss"))?;
        let mut values = Vec::new();
        for word in list.split(',').map(str::trim) {
            let ends = word.split_once("..").map(|(from, to)| (from.parse::<u32>(), to.parse::<u32>()));
            if let Some((Ok(from), Ok(to))) = ends
                && from <= to
                && to - from < MOST
            {
                values.extend((from..=to).map(Value::from));
                continue;
            }
            values.push(Value::parse(word)?);
        }
        Ok(Self { field, values })
    }
}

impl Axes {
    /// Replaces the values of axes; other fields become further axes. An axis may be named by the
    /// end of its name.
    pub fn change(&mut self, changes: &[Change]) -> Result<(), SweepError> {
        let place = |change: &Change| format!("{}=...", change.field);
        for change in changes {
            let Change { field, values } = change.clone();
            match find(self.axes.iter().map(|axis| axis.field.name()), field.name()) {
                Some(index) => {
                    let of_file = &self.axes[index];
                    if of_file.field.name() == SCENARIO && values.iter().any(|value| !of_file.values.contains(value)) {
                        let names: Vec<_> = of_file.values.iter().map(ToString::to_string).collect();
                        let remedy = format!("give some of {}", names.join(", "));
                        return Err(SweepError::new(place(change), "the plan has no such scenario", remedy));
                    }
                    (self.axes[index].values, self.axes[index].place) = (values, None);
                }
                None => {
                    self.groups.push(self.axes.len()..self.axes.len() + 1);
                    self.axes.push(Axis { field, values, place: None, is_log: false, is_range: false, span: 0..0 });
                }
            }
        }
        for group in &self.groups {
            let [first, others @ ..] = &self.axes[group.clone()] else { continue };
            let is_changed = first.span == (0..0) || changes.iter().any(|change| change.values == first.values);
            if let Some(twice) = twice(&first.values).filter(|_| others.is_empty() && is_changed) {
                let place = format!("{}=...", first.field);
                return Err(SweepError::new(place, format!("{twice} is listed twice"), "leave one out"));
            }
            if let Some(other) = others.iter().find(|other| other.values.len() != first.values.len()) {
                let [a, b] = [first, other].map(|axis| format!("{} values of {}", axis.values.len(), axis.field));
                let what = format!("{a} cannot advance with {b}");
                return Err(SweepError::new("--axis", what, "give as many values of each of them"));
            }
        }
        Ok(())
    }
}

/// The name, or the only name that ends in `.part`.
pub fn find<'a>(names: impl Iterator<Item = &'a str> + Clone, part: &str) -> Option<usize> {
    let is_end = |name: &str| name.strip_suffix(part).is_some_and(|rest| rest.ends_with('.'));
    names.clone().position(|name| name == part).or_else(|| {
        let mut ends = names.enumerate().filter(|(_, name)| is_end(name)).map(|(index, _)| index);
        ends.next().filter(|_| ends.next().is_none())
    })
}

struct Entry<'s, 'a> {
    field: Field,
    span: Range<usize>,
    value: &'s Node<'a>,
}

/// `scenarios`: names of the scenarios if there are several; they are the first axis.
pub fn read(source: &Source<'_>, file: &PlanFile, scenarios: Vec<Value>) -> Result<Axes, ScenarioError> {
    let mut all = Axes::default();
    if let Some(field) = Field::read(SCENARIO).filter(|_| scenarios.len() > 1) {
        all.groups.push(0..1);
        all.axes.push(Axis {
            field,
            values: scenarios,
            place: Some(Location::START),
            is_log: false,
            is_range: false,
            span: 0..0,
        });
    }
    for entry in entries(source, "axes")? {
        let axis = axis(source, entry)?;
        if let Some(twice) = twice(&axis.values) {
            let what = format!("{twice} is listed twice");
            return Err(source.error_at(axis.span, axis.field.name(), what, "leave one out; seeds make repetitions"));
        }
        all.groups.push(all.axes.len()..all.axes.len() + 1);
        all.axes.push(axis);
    }
    for index in 0..file.zip.len() {
        let field = format!("zip[{index}]");
        let entries = entries(source, &field)?;
        let group = entries.into_iter().map(|entry| axis(source, entry)).collect::<Result<Vec<_>, _>>()?;
        let [first, others @ ..] = &group[..] else {
            return Err(source.error(&field, "there are no fields", "give fields with lists of the same length"));
        };
        if let Some(other) = others.iter().find(|other| other.values.len() != first.values.len()) {
            let [a, b] = [first, other].map(|axis| format!("{} values of {}", axis.values.len(), axis.field));
            let what = format!("{a} cannot advance with {b}");
            return Err(source.error_at(other.span.clone(), &field, what, "give all of them equally many"));
        }
        all.groups.push(all.axes.len()..all.axes.len() + group.len());
        all.axes.extend(group);
    }
    for (index, sample) in file.sample.iter().enumerate() {
        let field = format!("sample[{index}]");
        if !(1..=MOST).contains(&sample.count) {
            let what = format!("{} samples", sample.count);
            return Err(source.error(&format!("{field}.count"), what, format!("give 1 to {MOST}")));
        }
        let entries = entries(source, &format!("{field}.axes"))?;
        if entries.is_empty() {
            return Err(source.error(&field, "there are no fields", "give some in `axes`"));
        }
        let group = (0..).zip(entries).map(|(number, entry)| sampled(source, entry, sample, number));
        let group = group.collect::<Result<Vec<_>, _>>()?;
        all.groups.push(all.axes.len()..all.axes.len() + group.len());
        all.axes.extend(group);
    }
    for Entry { field, span, value } in entries(source, "set")? {
        let read = Value::read(value.get_ref());
        let value = read.map_err(|what| source.error_at(span.clone(), field.name(), what, "give one value"))?;
        all.set.push((field, value, span));
    }
    let fields = all.axes.iter().map(|axis| (&axis.field, &axis.span));
    let fields: Vec<_> = fields.chain(all.set.iter().map(|(field, _, span)| (field, span))).collect();
    for (index, (field, span)) in fields.iter().enumerate() {
        let wrong = |what: &str, remedy: &str| Err(source.error_at((*span).clone(), field.name(), what, remedy));
        match field.name() {
            "seed" => return wrong("seeds are not an axis", "give `seeds`"),
            "name" => return wrong("it is a text, and no run depends on it", "leave it out"),
            _ if fields[..index].iter().any(|(other, _)| other == field) => {
                return wrong("it is named twice", "leave one out");
            }
            _ => {}
        }
    }
    Ok(all)
}

pub fn check_kind(source: &Source<'_>, axis: &Axis, present: Option<&Node<'_>>) -> Result<(), ScenarioError> {
    let is = match present.map(Node::get_ref) {
        Some(DeValue::String(word)) => format!("a text ({word:?})"),
        Some(DeValue::Boolean(_)) => "true or false".to_owned(),
        Some(DeValue::Array(_) | DeValue::Table(_)) => {
            let remedy = "name a field in it, or an element: [0]";
            return Err(source.error_at(axis.span.clone(), axis.field.name(), "it is a list or a table", remedy));
        }
        _ => return Ok(()),
    };
    if axis.is_range {
        let (what, remedy) = no_range(&is);
        return Err(source.error_at(axis.span.clone(), axis.field.name(), what, remedy));
    }
    Ok(())
}

pub fn no_range(is: &str) -> (String, String) {
    (format!("it is {is}, which has no range"), "give a list of values".to_owned())
}

/// The fields in a table of the plan, in the order of the text; nested tables give dotted names. A
/// table with `from` is a range.
fn entries<'s, 'a>(source: &'s Source<'a>, table: &str) -> Result<Vec<Entry<'s, 'a>>, ScenarioError> {
    let mut found = Vec::new();
    if let Some(table) = source.get(table).and_then(|node| node.get_ref().as_table()) {
        collect(table, "", &mut found);
    }
    found.sort_by_key(|(_, span, _)| span.start);
    let entry = |(name, span, value): (String, Range<usize>, _)| match Field::read(&name) {
        Some(field) => Ok(Entry { field, span, value }),
        None => {
            let remedy = "write names as in radio.loss or \"plane.group[0].count\"";
            Err(source.error_at(span, &name, "it is not the name of a field", remedy))
        }
    };
    found.into_iter().map(entry).collect()
}

fn collect<'s, 'a>(table: &'s DeTable<'a>, prefix: &str, found: &mut Vec<(String, Range<usize>, &'s Node<'a>)>) {
    for (key, value) in table {
        let name = if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
        match value.get_ref() {
            DeValue::Table(inner) if !inner.contains_key("from") => collect(inner, &name, found),
            _ => found.push((name, key.span(), value)),
        }
    }
}

fn axis(source: &Source<'_>, Entry { field, span, value }: Entry<'_, '_>) -> Result<Axis, ScenarioError> {
    let wrong = |what: String, remedy: &str| source.error_at(span.clone(), field.name(), what, remedy);
    let (values, is_log, is_range) = match value.get_ref() {
        DeValue::Array(list) => {
            let values = list.iter().map(|node| Value::read(node.get_ref())).collect::<Result<Vec<_>, _>>();
            let remedy =
                "give numbers, true and false, or words without comma; for lists name the element, as in place_m[0]";
            (values.map_err(|what| wrong(what, remedy))?, false, false)
        }
        DeValue::Table(_) => {
            let range = RangeTable::read(value)
                .map_err(|cause| wrong(cause.what, "give { from, to, count } or { from, to, step }"))?;
            (spread(&range).map_err(|(what, remedy)| wrong(what, remedy))?, range.log, true)
        }
        _ => return Err(wrong("one value is not an axis".to_owned(), "give a list, a range, or put it into [set]")),
    };
    if values.is_empty() {
        return Err(wrong("there are no values".to_owned(), "give one or more"));
    }
    let place = Some(source.location(span.start));
    Ok(Axis { field, values, place, is_log, is_range, span })
}

fn spread(range: &RangeTable) -> Result<Vec<Value>, (String, &'static str)> {
    let RangeTable { from, to, log, .. } = *range;
    check_ends(range)?;
    let values: Vec<f64> = match (range.count, range.step) {
        (Some(count), None) => {
            if !(2..=MOST).contains(&count) {
                return Err((format!("{count} values are not a range"), "give 2 to 1000000"));
            }
            (0..count).map(|number| between(range, f64::from(number) / f64::from(count - 1))).collect()
        }
        (None, Some(step)) => {
            let steps = libm::floor((to - from) / step + 1e-9);
            if log || !step.is_finite() || !(0.0..f64::from(MOST)).contains(&steps) {
                let [step, from, to] = [step, from, to].map(Value::of);
                let what = format!("steps of {step} do not lead from {from} to {to}");
                return Err((what, "give a step towards `to`, at most a million times; for equal ratios give `count`"));
            }
            (0..=steps as u32).map(|number| neat(from + f64::from(number) * step)).collect()
        }
        _ => return Err(("it is not clear how many values there are".to_owned(), "give exactly one of count, step")),
    };
    let mut values: Vec<Value> = values.into_iter().map(|value| rounded(range, value)).collect();
    values.dedup();
    Ok(values)
}

fn check_ends(range: &RangeTable) -> Result<(), (String, &'static str)> {
    let RangeTable { from, to, log, .. } = *range;
    let wrong = |what: &str, remedy| Err((format!("{} to {} {what}", Value::of(from), Value::of(to)), remedy));
    if log && !(from > 0.0 && to > 0.0) {
        return wrong("has no equal ratios", "give ends above 0, or leave out log");
    }
    // Infinite for ends that are infinite or too far apart.
    let width = if log { to / from } else { to - from };
    if !width.is_finite() || (log && width == 0.0) {
        return wrong("is not a range", "give finite ends, nearer to each other");
    }
    Ok(())
}

fn between(range: &RangeTable, share: f64) -> f64 {
    let RangeTable { from, to, log, .. } = *range;
    if share == 0.0 {
        from
    } else if share == 1.0 {
        to
    } else if log {
        neat(from * libm::pow(to / from, share))
    } else {
        neat(from + (to - from) * share)
    }
}

/// Twelve digits, for 0.3 instead of 0.30000000000000004.
fn neat(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

fn rounded(range: &RangeTable, value: f64) -> Value {
    Value::of(if range.whole { libm::round(value) } else { value })
}

fn sampled(
    source: &Source<'_>,
    Entry { field, span, value }: Entry<'_, '_>,
    sample: &SampleTable,
    number: u32,
) -> Result<Axis, ScenarioError> {
    let shares = shares(sample.kind, sample.seed, number, sample.count);
    let wrong = |what: String, remedy: &str| source.error_at(span.clone(), field.name(), what, remedy);
    let is_ends = value.get_ref().is_table();
    let (values, is_log) = if is_ends {
        let range = RangeTable::read(value).map_err(|cause| wrong(cause.what, "give { from, to }"))?;
        if range.count.is_some() || range.step.is_some() {
            return Err(wrong("how many values there are is the sample's".to_owned(), "give { from, to }"));
        }
        check_ends(&range).map_err(|(what, remedy)| wrong(what, remedy))?;
        if range.from > range.to {
            let what = format!("{} to {} is a reversed range", Value::of(range.from), Value::of(range.to));
            return Err(wrong(what, "give the smaller number first"));
        }
        (shares.iter().map(|&share| rounded(&range, between(&range, share))).collect(), range.log)
    } else {
        let of = axis(source, Entry { field: field.clone(), span: span.clone(), value })?.values;
        let at = |share: f64| (share * of.len() as f64) as usize;
        (shares.iter().map(|&share| of[at(share).min(of.len() - 1)].clone()).collect(), false)
    };
    let place = Some(source.location(span.start));
    Ok(Axis { field, values, place, is_log, is_range: is_ends, span })
}

fn twice(values: &[Value]) -> Option<String> {
    let mut texts: Vec<String> = values.iter().map(ToString::to_string).collect();
    texts.sort_unstable();
    texts.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0].clone())
}
