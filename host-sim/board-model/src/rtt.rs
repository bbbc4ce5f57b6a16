//! The firmware's log: SEGGER's RTT control block in the emulated memory, read like a debug probe
//! does.

/// Access to the emulated memory.
pub trait Memory {
    /// Reads bytes.
    fn read(&mut self, address: u32, bytes: &mut [u8]);
    /// Writes bytes.
    fn write(&mut self, address: u32, bytes: &[u8]);
}

/// Bytes of the identifier and the two channel counts.
const HEAD: u32 = 24;
const ID: &[u8] = b"SEGGER RTT";

/// Reads the new output of channel 0; empty before the firmware has set up the block.
pub fn drain(memory: &mut dyn Memory, block: u32) -> Vec<u8> {
    let mut id = [0; ID.len()];
    memory.read(block, &mut id);
    if id != ID {
        return Vec::new();
    }
    let mut word = |place: u32| {
        let mut bytes = [0; 4];
        memory.read(block + HEAD + 4 * place, &mut bytes);
        u32::from_le_bytes(bytes)
    };
    // Name, buffer, size, write and read position, flags.
    let (buffer, size, written, read) = (word(1), word(2), word(3), word(4));
    if size == 0 || written >= size || read >= size {
        return Vec::new();
    }
    let mut bytes = vec![0; size as usize];
    memory.read(buffer, &mut bytes);
    memory.write(block + HEAD + 16, &written.to_le_bytes());
    bytes.rotate_left(read as usize);
    bytes.truncate(((written + size - read) % size) as usize);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Ram(Vec<u8>);

    impl Memory for Ram {
        fn read(&mut self, address: u32, bytes: &mut [u8]) {
            let at = address as usize;
            bytes.copy_from_slice(&self.0[at..at + bytes.len()]);
        }
        fn write(&mut self, address: u32, bytes: &[u8]) {
            let at = address as usize;
            self.0[at..at + bytes.len()].copy_from_slice(bytes);
        }
    }

    #[test]
    fn what_was_written_is_taken_once_across_the_buffers_end() {
        let mut ram = Ram(vec![0; 128]);
        assert!(drain(&mut ram, 0).is_empty());
        ram.write(0, ID);
        for (place, word) in [(1, 100_u32), (2, 8), (3, 2), (4, 6)] {
            ram.write(HEAD + 4 * place, &word.to_le_bytes());
        }
        ram.write(100, b"cd....ab");
        assert_eq!(drain(&mut ram, 0), b"abcd");
        assert!(drain(&mut ram, 0).is_empty());
    }
}
