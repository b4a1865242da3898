//! Mode 0, attributes: differences to the element before, byte by byte, in blocks of groups of 16.

use super::stream::{Problem, Stream, unzigzag};

/// Elements whose differences are stored together.
const GROUP: usize = 16;
/// Most bytes of a block once it is decoded.
const BLOCK: usize = 8192;
/// Most elements of a block.
const BLOCK_ELEMENTS: usize = 256;

/// How the differences of 4 bytes of an element are to be understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Channel {
    /// Each byte is a zigzag difference.
    Bytes,
    /// So are both 16-bit numbers.
    Words,
    /// The 32-bit number is a difference by XOR that was rotated to the left.
    Xor(u32),
}

/// Decode `count` elements of `stride` bytes, a multiple of 4 up to 256.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, Problem> {
    let newer = match bytes.first() {
        Some(0xA0) => false,
        Some(0xA1) => true,
        _ => return Err("it is no stream of attributes of version 0 or 1"),
    };
    // The tail: zeros for short elements, the element before the first, a byte a channel.
    let (used, least) = match newer {
        true => (stride + stride / 4, 24),
        false => (stride, 32),
    };
    let (_, mut stream, tail) = Stream::split(bytes, used.max(least))?;
    let tail = &tail[tail.len() - used..];
    let (first, channels) = tail.split_at(stride);
    let channels = match newer {
        true => channels
            .iter()
            .map(|&byte| channel(byte))
            .collect::<Result<_, _>>()?,
        false => vec![Channel::Bytes; stride / 4],
    };
    let mut last = first.to_vec();
    let mut elements = vec![0; count * stride];
    let most = (BLOCK / stride / GROUP * GROUP).min(BLOCK_ELEMENTS);
    let mut deltas = vec![0; most * stride];
    for block in elements.chunks_mut(most * stride) {
        let length = block.len() / stride;
        read_deltas(&mut stream, newer, length, stride, &mut deltas)?;
        for (channel, kind) in channels.iter().enumerate() {
            let at = 4 * channel;
            let rows = &deltas[at * most..][..4 * most];
            let last = &mut last[at..at + 4];
            let elements = block
                .chunks_exact_mut(stride)
                .map(|element| &mut element[at..at + 4]);
            kind.undo(rows, most, last, elements);
        }
    }
    stream.end()?;
    Ok(elements)
}

fn channel(byte: u8) -> Result<Channel, Problem> {
    match (byte & 0x0F, byte >> 4) {
        (0, 0) => Ok(Channel::Bytes),
        (1, 0) => Ok(Channel::Words),
        (2, turn) => Ok(Channel::Xor(turn.into())),
        _ => Err("a channel has an unknown mode"),
    }
}

impl Channel {
    /// From the differences of 4 bytes, each in a row of its own, to the elements' 4 bytes.
    fn undo<'e>(
        self,
        rows: &[u8],
        most: usize,
        last: &mut [u8],
        elements: impl Iterator<Item = &'e mut [u8]>,
    ) {
        let (mut a, mut b, mut c, mut d) = (last[0], last[1], last[2], last[3]);
        for (index, element) in elements.enumerate() {
            let delta = [0, 1, 2, 3].map(|row| rows[row * most + index]);
            [a, b, c, d] = self.next([a, b, c, d], delta);
            element.copy_from_slice(&[a, b, c, d]);
        }
        last.copy_from_slice(&[a, b, c, d]);
    }

    fn next(self, last: [u8; 4], delta: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => {
                std::array::from_fn(|i| last[i].wrapping_add(unzigzag(delta[i].into()) as u8))
            }
            Self::Words => {
                let word = |of: [u8; 4], i: usize| u16::from_le_bytes([of[i], of[i + 1]]);
                let sum = |i| {
                    let step = unzigzag(word(delta, i).into()) as u16;
                    word(last, i).wrapping_add(step).to_le_bytes()
                };
                let ([a, b], [c, d]) = (sum(0), sum(2));
                [a, b, c, d]
            }
            Self::Xor(turn) => {
                let delta = u32::from_le_bytes(delta).rotate_right(turn);
                (u32::from_le_bytes(last) ^ delta).to_le_bytes()
            }
        }
    }
}

/// The differences of a block of `length` elements: row k holds those of byte k, `deltas.len() / stride` apart.
fn read_deltas(
    stream: &mut Stream,
    newer: bool,
    length: usize,
    stride: usize,
    deltas: &mut [u8],
) -> Result<(), Problem> {
    let most = deltas.len() / stride;
    let controls = match newer {
        true => stream.take(stride / 4)?,
        false => &[],
    };
    for (byte, row) in deltas.chunks_exact_mut(most).enumerate() {
        let control = controls
            .get(byte / 4)
            .map(|bits| bits >> (2 * (byte % 4)) & 3);
        match control {
            None => read_groups(stream, [0, 2, 4, 8], length, row)?,
            Some(0) => read_groups(stream, [0, 1, 2, 4], length, row)?,
            Some(1) => read_groups(stream, [1, 2, 4, 8], length, row)?,
            Some(2) => row[..length].fill(0),
            _ => row[..length].copy_from_slice(stream.take(length)?),
        }
    }
    Ok(())
}

/// Groups of 16 differences, each of one of four widths in bits, which 2 bits a group choose.
fn read_groups(
    stream: &mut Stream,
    widths: [usize; 4],
    length: usize,
    row: &mut [u8],
) -> Result<(), Problem> {
    let groups = length.div_ceil(GROUP);
    let headers = stream.take(groups.div_ceil(4))?;
    for (group, row) in row.chunks_exact_mut(GROUP).take(groups).enumerate() {
        let header = headers[group / 4] >> (2 * (group % 4)) & 3;
        match widths[usize::from(header)] {
            0 => row.fill(0),
            8 => row.copy_from_slice(stream.take(GROUP)?),
            width => read_group(stream, width, row)?,
        }
    }
    Ok(())
}

/// 16 differences of 1, 2 or 4 bits; all bits set stand for one in a byte of its own, after the others.
fn read_group(stream: &mut Stream, width: usize, row: &mut [u8]) -> Result<(), Problem> {
    let packed = stream.take(GROUP * width / 8)?;
    let sentinel = (1_u8 << width) - 1;
    for (index, delta) in row.iter_mut().enumerate() {
        let bit = index * width;
        // Single bits begin at the lowest one of a byte, wider ones at the highest.
        let shift = match width {
            1 => bit % 8,
            _ => 8 - width - bit % 8,
        };
        *delta = packed[bit / 8] >> shift & sentinel;
        if *delta == sentinel {
            *delta = stream.byte()?;
        }
    }
    Ok(())
}
