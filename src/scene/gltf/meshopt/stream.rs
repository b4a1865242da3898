//! Reading a compressed stream from its front.

/// What is wrong with a stream.
pub(super) type Problem = &'static str;

/// The bytes that are still to be read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stream<'a>(&'a [u8]);

impl<'a> Stream<'a> {
    /// A stream's header byte, its body and its last `tail` bytes.
    pub fn split(bytes: &'a [u8], tail: usize) -> Result<(u8, Self, &'a [u8]), Problem> {
        let (&header, rest) = bytes.split_first().ok_or("it is empty")?;
        let body = rest.len().checked_sub(tail).ok_or("it ends too early")?;
        let (body, tail) = rest.split_at(body);
        Ok((header, Self(body), tail))
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Problem> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or("it ends too early")?;
        self.0 = rest;
        Ok(taken)
    }

    /// The next byte.
    pub fn byte(&mut self) -> Result<u8, Problem> {
        self.take(1).map(|bytes| bytes[0])
    }

    /// An unsigned LEB128 number of 32 bits; what does not fit is cut off.
    pub fn varint(&mut self) -> Result<u32, Problem> {
        let mut value = 0_u32;
        for step in 0..5 {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7F) << (7 * step);
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err("a number has more than 5 bytes")
    }

    /// Nothing may be left.
    pub fn end(self) -> Result<(), Problem> {
        match self.0.is_empty() {
            true => Ok(()),
            false => Err("it has more bytes than its elements need"),
        }
    }
}

/// 0, 1, 2, 3, … stand for 0, −1, 1, −2, …
pub(super) fn unzigzag(value: u32) -> u32 {
    (value >> 1) ^ (value & 1).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unsigned LEB128, the lowest bits first. The last of the specification's three examples has them the other way
    /// round; the reference encoder does not.
    #[test]
    fn numbers_have_seven_bits_a_byte() {
        let examples: [(&[u8], u32); 3] = [
            (&[0x7F], 0x7F),
            (&[0x81, 0x04], 0x201),
            (&[0xFF, 0xA0, 0x05], 0x1_507F),
        ];
        for (bytes, value) in examples {
            let mut stream = Stream(bytes);
            assert_eq!(stream.varint(), Ok(value));
            assert_eq!(stream.end(), Ok(()));
        }
        assert!(Stream(&[0x80]).varint().is_err());
        assert!(Stream(&[0x80; 6]).varint().is_err());
    }
}
