use super::model::VehicleModel;
use staya_controller::parameters::{Parameter, RADIUS, SPEED, TOLERANCE};
use staya_mavlink::constants::MAV_PARAM_TYPE_REAL32;
use staya_mavlink::dialect::PARAM_VALUE_DATA;

/// The setting of the bridge itself: timeout of velocity setpoints, simulated seconds.
pub const SETPOINT_TIMEOUT: &str = "setpoint_timeout_s";
/// ArduPilot Rover's default.
const SETPOINT_TIMEOUT_S: f32 = 3.0;

#[derive(Clone, Debug, PartialEq)]
struct Entry {
    /// As clients know it.
    name: &'static str,
    /// The name of the controller's parameter, or [`SETPOINT_TIMEOUT`].
    setting: &'static str,
    value: f32,
    range: [f32; 2],
}

/// All parameters of a vehicle, sorted by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    entries: Vec<Entry>,
    next: usize,
    left: usize,
}

impl Parameters {
    /// Creates the parameters of a robot from those of its controller and their values.
    pub fn new(model: &VehicleModel, values: &[(&'static Parameter, f32)]) -> Self {
        let of_bodies = [RADIUS, SPEED, TOLERANCE].map(|row| row.name);
        let own = values.iter().filter(|(row, _)| model.grid.is_none() || !of_bodies.contains(&row.name));
        let own = own.map(|&(&Parameter { name, mavlink, range: [mut least, mut greatest], .. }, value)| {
            // A radius below the real one would cause collisions.
            if name == RADIUS.name {
                least = model.radius_m;
            } else if name == SPEED.name {
                greatest = model.max_speed_mps;
            }
            Entry { name: mavlink, setting: name, value, range: [least, greatest] }
        });
        let timeout = model.grid.is_none().then_some(Entry {
            name: "SETPOINT_S",
            setting: SETPOINT_TIMEOUT,
            value: SETPOINT_TIMEOUT_S,
            range: [0.05, 600.0],
        });
        let mut entries: Vec<_> = own.chain(timeout).collect();
        entries.sort_by_key(|entry| entry.name);
        Self { entries, next: 0, left: 0 }
    }

    /// Number of parameters.
    pub const fn count(&self) -> usize {
        self.entries.len()
    }

    /// Starts listing each parameter once; during a listing the count restarts.
    pub const fn list(&mut self) {
        self.left = self.count();
    }

    /// Whether parameters remain to be listed.
    pub const fn is_listing(&self) -> bool {
        self.left > 0
    }

    /// The next parameter of the listing.
    pub fn next_listed(&mut self) -> Option<PARAM_VALUE_DATA> {
        self.left = self.left.checked_sub(1)?;
        let told = self.message(self.next);
        self.next = (self.next + 1) % self.count().max(1);
        told
    }

    /// Index of the parameter that `param_id` names.
    pub fn find(&self, id: &[u8; 16]) -> Option<usize> {
        let end = id.iter().position(|letter| *letter == 0);
        let id = &id[..end.unwrap_or(id.len())];
        self.entries.iter().position(|entry| entry.name.as_bytes() == id)
    }

    /// Value of a setting; `None` if the vehicle lacks it.
    pub fn get(&self, setting: &str) -> Option<f32> {
        Some(self.entries[self.index_of(setting)?].value)
    }

    /// Index of a setting; `None` if the vehicle lacks it.
    pub fn index_of(&self, setting: &str) -> Option<usize> {
        self.entries.iter().position(|entry| entry.setting == setting)
    }

    /// Sets a parameter by index. Returns the setting that changed.
    ///
    /// # Errors
    /// The value is outside these limits, and unchanged.
    pub fn set(&mut self, index: usize, value: f32) -> Result<&'static str, [f32; 2]> {
        let entry = &mut self.entries[index];
        let [least, greatest] = entry.range;
        if !(least..=greatest).contains(&value) {
            return Err(entry.range);
        }
        entry.value = value;
        Ok(entry.setting)
    }

    /// Overwrites a value with the one that the controller uses. Returns its index.
    pub fn set_back(&mut self, setting: &str, value: f32) -> Option<usize> {
        let index = self.index_of(setting)?;
        self.entries[index].value = value;
        Some(index)
    }

    /// PARAM_VALUE of the parameter at `index`.
    pub fn message(&self, index: usize) -> Option<PARAM_VALUE_DATA> {
        let entry = self.entries.get(index)?;
        Some(PARAM_VALUE_DATA {
            param_value: entry.value,
            param_count: self.entries.len() as u16,
            param_index: index as u16,
            param_id: entry.name.into(),
            param_type: MAV_PARAM_TYPE_REAL32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{greatest, model, on_grid};
    use super::*;

    fn padded(name: &str) -> [u8; 16] {
        let mut id = [0; 16];
        id[..name.len()].copy_from_slice(name.as_bytes());
        id
    }

    fn all() -> Parameters {
        Parameters::new(&model(), &greatest())
    }

    #[test]
    fn parameter_names_fit_and_find_their_index() {
        let parameters = all();
        assert_eq!(parameters.count(), greatest().len() + 1);
        for index in 0..parameters.count() {
            let name = parameters.entries[index].name;
            assert_eq!(parameters.find(&padded(name)), Some(index), "{name}");
            let told = parameters.message(index).expect("it is there");
            assert_eq!((*told.param_id, usize::from(told.param_index)), (padded(name), index));
        }
        assert_eq!(parameters.find(&padded("SPEED_MP")), None);
        assert_eq!(parameters.find(&padded("")), None);
        assert_eq!(parameters.message(parameters.count()), None);
    }

    #[test]
    fn repeated_list_requests_send_each_parameter_once_per_round() {
        let mut parameters = all();
        assert_eq!(parameters.next_listed(), None);
        let count = parameters.count() as u16;
        parameters.list();
        let told = |parameters: &mut Parameters| parameters.next_listed().map(|told| told.param_index);
        for index in 0..3 {
            assert_eq!(told(&mut parameters), Some(index));
        }
        for _ in 0..200 {
            parameters.list();
        }
        let round: Vec<_> = std::iter::from_fn(|| told(&mut parameters)).collect();
        assert_eq!(round, (3..count).chain(0..3).collect::<Vec<_>>());
        assert!(!parameters.is_listing());
    }

    #[test]
    fn a_value_out_of_range_is_not_set() {
        let mut parameters = all();
        let speed = parameters.find(&padded("SPEED_MPS")).expect("it is there");
        let limit = model().max_speed_mps;
        for bad in [-0.1, limit * 1.01, f32::NAN, f32::INFINITY] {
            let before = parameters.clone();
            assert_eq!(parameters.set(speed, bad), Err([0.0, limit]));
            assert_eq!(parameters, before);
        }
        assert_eq!(parameters.set(speed, limit), Ok(SPEED.name));
        assert_eq!(parameters.get(SPEED.name), Some(limit));
        let radius = parameters.index_of(RADIUS.name).expect("it is there");
        assert!(parameters.set(radius, model().radius_m * 0.9).is_err());
    }

    #[test]
    fn a_grid_robot_has_no_body_parameters() {
        let parameters = Parameters::new(&on_grid(), &greatest());
        let is_there = |name| parameters.find(&padded(name)).is_some();
        assert!(is_there("BEACON_S") && is_there("ROUTE_A3"));
        assert!(!is_there("SPEED_MPS") && !is_there("RADIUS_M") && !is_there("SETPOINT_S"));
    }
}
