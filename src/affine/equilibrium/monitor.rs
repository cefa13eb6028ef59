//! Monitors of an equilibrium: values of expressions in states and parameters, with their derivatives in the unknowns.

use super::curve::EquilibriumCurve;
use super::field::LocalField;
use crate::affine::monitor::MonitorSource;
use crate::linalg::Vector;
use crate::orbit::monitor::MonitorValue;

impl EquilibriumCurve {
    /// A monitor at scaled unknowns: an extreme or a mean is the value. `None` where it has none.
    pub(super) fn observed_at(&self, number: usize, point: &Vector) -> Option<MonitorValue> {
        let observed = self.observed.as_ref()?;
        let mode = self.signature.mode;
        let form = observed.forms.get(&mode)?.get(number)?;
        let source = &self.setting.system.monitors().get(number)?.source;
        let place = self.place(point);
        let local = LocalField {
            lifted: &observed.system,
            signs: &[],
            ..self.local(&place)
        };
        let linear = local.form(form).scaled(&self.setting.scales.units, 1.0);
        let sign = match source {
            MonitorSource::Largest(_) if linear.value < 0.0 => -1.0,
            MonitorSource::Max(_)
            | MonitorSource::Min(_)
            | MonitorSource::Mean(_)
            | MonitorSource::Largest(_) => 1.0,
            // what only orbits have
            MonitorSource::Integral(_) | MonitorSource::Before(..) | MonitorSource::After(..) => {
                return None;
            }
        };
        let gradient: Vec<f64> = linear.by.iter().map(|by| sign * by).collect();
        let is_finite = linear.value.is_finite() && gradient.iter().all(|by| by.is_finite());
        is_finite.then_some(MonitorValue {
            value: sign * linear.value,
            gradient,
        })
    }

    /// Names and values of all monitors.
    pub fn monitors(&self, point: &Vector) -> Vec<(String, Option<f64>)> {
        let all = self.setting.system.monitors().iter().enumerate();
        all.map(|(number, monitor)| {
            let value = self.observed_at(number, point);
            (monitor.name.clone(), value.map(|measured| measured.value))
        })
        .collect()
    }
}
