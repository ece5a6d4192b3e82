//! Variables of several states as those of one.
use super::{LOCALS, StoredValue, Value, Vars};

impl Vars {
    /// Returns the variables of several states: `join` gives the value of a slot that differs or isn't a known number.
    ///
    /// `None` if a slot is vacant in some states alone, counts increments in some, or `join` gives no value.
    pub(in super::super) fn joined(
        &self,
        others: &[&Self],
        join: &mut impl FnMut(usize, &[Value]) -> Option<Value>,
    ) -> Option<Self> {
        let has_same_shape =
            |other: &&Self| self.outer_locals.len() == other.outer_locals.len() && self.names == other.names;
        if !others.iter().all(has_same_shape) {
            return None;
        }
        let mut joined = self.clone();
        let mut of_slot = |slot: usize, this: StoredValue, others: &mut dyn Iterator<Item = StoredValue>| {
            let mut values = vec![Value::from(this)];
            let (mut is_same, mut is_alike) = (true, true);
            for other in others {
                is_same &= this.bits() == other.bits();
                is_alike &= this.is_vacant == other.is_vacant && this.decimals == other.decimals;
                values.push(other.into());
            }
            if !is_alike {
                return None;
            }
            if is_same && !this.number.is_nan() { Some(Value::from(this)) } else { join(slot, &values) }
        };
        for index in 0..self.indices() {
            let this = self.stored_value(index);
            let value = of_slot(index, this, &mut others.iter().map(|other| other.stored_value(index)))?;
            if StoredValue::from(value).bits() != this.bits() {
                joined.set(index, value);
            }
        }
        for (level, locals) in self.outer_locals.iter().enumerate() {
            for (local, this) in locals.0.iter().enumerate() {
                let slot = self.indices() + level * LOCALS + local;
                let mut values = others.iter().map(|other| other.outer_locals[level].0[local]);
                let value = of_slot(slot, *this, &mut values)?;
                if StoredValue::from(value).bits() != this.bits() {
                    joined.set_outer_local(level, local, value);
                }
            }
        }
        Some(joined)
    }
}
