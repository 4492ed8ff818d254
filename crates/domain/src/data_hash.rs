//! The hash of a run's readings: what a fit depends on beside the drive and the sample.

use super::{Channel, Quantity};

/// BLAKE3 of the interpreted channels, hexadecimal: quantities, times, values and exclusions.
pub fn data_hash(channels: &[Channel]) -> String {
    let mut hasher = blake3::Hasher::new();
    for channel in channels.iter().filter(|c| c.quantity != Quantity::Other) {
        hasher.update(channel.quantity.key().as_bytes());
        // A whole-strip channel hashes as it did before positions were known.
        if let Some(position_mm) = channel.position_mm {
            hasher.update(&position_mm.to_le_bytes());
        }
        hasher.update(&(channel.len() as u64).to_le_bytes());
        hasher.update(&bytes(&channel.time_s));
        hasher.update(&bytes(&channel.values));
        hasher.update(
            &channel
                .excluded
                .iter()
                .flat_map(|index| index.to_le_bytes())
                .collect::<Vec<u8>>(),
        );
    }
    hasher.finalize().to_hex().to_string()
}

fn bytes(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn readings_count_and_foreign_columns_do_not() {
        let channel =
            |values: [f64; 2]| Channel::new(Quantity::Current, Arc::from([0.0, 1.0]), Arc::from(values));
        let mut other = channel([7.0, 7.0]);
        other.quantity = Quantity::Other;
        assert_eq!(
            data_hash(&[channel([1.0, 2.0])]),
            data_hash(&[channel([1.0, 2.0]), other])
        );
        assert_ne!(
            data_hash(&[channel([1.0, 2.0])]),
            data_hash(&[channel([1.0, 2.5])])
        );
        let mut excluded = channel([1.0, 2.0]);
        excluded.excluded = Arc::from([1]);
        assert_ne!(data_hash(&[channel([1.0, 2.0])]), data_hash(&[excluded]));
    }
}
