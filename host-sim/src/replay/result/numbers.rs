//! JSON form of an `f32` of the core: its shortest digits, 0.78 and not 0.7799999713897705, which
//! read back as the same `f32`; `null` for NaN and infinity.

/// For a number that is always known.
pub(in crate::replay) mod short {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(in crate::replay) fn serialize<S: Serializer>(
        value: &f64,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        to.serialize_f32(*value as f32)
    }

    pub(in crate::replay) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<f64, D::Error> {
        f32::deserialize(from).map(f64::from)
    }
}

/// For a number that may be unknown.
pub(in crate::replay) mod short_or_null {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::replay) fn serialize<S: Serializer>(
        value: &Option<f64>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        value.map(|value| value as f32).serialize(to)
    }

    pub(in crate::replay) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<f64>, D::Error> {
        Option::<f32>::deserialize(from).map(|value| value.map(f64::from))
    }
}

/// For an interval.
pub(in crate::replay) mod short_pair {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    type Pair = Option<[f64; 2]>;

    pub(in crate::replay) fn serialize<S: Serializer>(
        ends: &Pair,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let end = |end: f64| Some(end as f32).filter(|end| end.is_finite());
        ends.map(|ends| ends.map(end)).serialize(to)
    }

    pub(in crate::replay) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Pair, D::Error> {
        Ok(Option::<[Option<f32>; 2]>::deserialize(from)?
            .and_then(|[low, high]| Some([f64::from(low?), f64::from(high?)])))
    }
}
