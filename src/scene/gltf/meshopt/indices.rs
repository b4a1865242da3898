//! Modes 1 and 2: triangles as edges and vertices seen shortly before, and indices as differences.

use super::stream::{Problem, Stream, unzigzag};

/// The last 16 values pushed.
#[derive(Debug, Default)]
struct Fifo<T> {
    values: [T; 16],
    pushed: usize,
}

impl<T: Copy> Fifo<T> {
    fn push(&mut self, value: T) {
        self.values[self.pushed % 16] = value;
        self.pushed += 1;
    }

    /// The value pushed `back` pushes before the last one, `back` < 16.
    fn get(&self, back: usize) -> Result<T, Problem> {
        let at = self.pushed.checked_sub(1 + back);
        at.map(|at| self.values[at % 16])
            .ok_or("a triangle refers to one before the first")
    }
}

/// What the decoder of triangles remembers.
#[derive(Debug)]
struct Triangles<'a> {
    data: Stream<'a>,
    table: &'a [u8],
    next: u32,
    last: u32,
    edges: Fifo<[u32; 2]>,
    vertices: Fifo<u32>,
}

/// Decode `count` indices, a multiple of 3, of a list of triangles.
pub(super) fn triangles(bytes: &[u8], count: usize) -> Result<Vec<u32>, Problem> {
    let (header, mut data, table) = Stream::split(bytes, 16)?;
    if header != 0xE1 {
        return Err("it is no stream of triangles");
    }
    let reserved = |byte: &u8| byte >> 4 == 0xF || byte & 0xF == 0xF;
    if table[14..] != [0, 0] || table.iter().any(reserved) {
        return Err("its table is not allowed");
    }
    let codes = data.take(count / 3)?;
    let mut state = Triangles {
        data,
        table,
        next: 0,
        last: 0,
        edges: Fifo::default(),
        vertices: Fifo::default(),
    };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        indices.extend(state.triangle(code)?);
    }
    state.data.end()?;
    Ok(indices)
}

impl Triangles<'_> {
    fn triangle(&mut self, code: u8) -> Result<[u32; 3], Problem> {
        let (high, low) = (code >> 4, code & 0xF);
        match high {
            0xF => self.apart(low),
            _ => self.across_edge(high.into(), low),
        }
    }

    /// A triangle that shares an edge with an earlier one.
    fn across_edge(&mut self, edge: usize, code: u8) -> Result<[u32; 3], Problem> {
        let [a, b] = self.edges.get(edge)?;
        let c = match code {
            0 => self.fresh(),
            1..=12 => self.vertices.get(code.into())?,
            13 => self.near(u32::MAX),
            14 => self.near(1),
            _ => self.explicit()?,
        };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if !(1..=12).contains(&code) {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// A triangle that shares no edge with those remembered.
    fn apart(&mut self, code: u8) -> Result<[u32; 3], Problem> {
        let (a, pair) = match code {
            0..=13 => (self.fresh(), self.table[usize::from(code)]),
            _ => {
                let pair = self.data.byte()?;
                if pair == 0 {
                    self.next = 0;
                }
                let a = match code {
                    14 => self.fresh(),
                    _ => self.explicit()?,
                };
                (a, pair)
            }
        };
        let (b, b_is_new) = self.vertex(pair >> 4)?;
        let (c, c_is_new) = self.vertex(pair & 0xF)?;
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        for (vertex, is_new) in [(a, true), (b, b_is_new), (c, c_is_new)] {
            if is_new {
                self.vertices.push(vertex);
            }
        }
        Ok([a, b, c])
    }

    /// The vertex that 4 bits stand for, and whether it is to be remembered.
    fn vertex(&mut self, code: u8) -> Result<(u32, bool), Problem> {
        Ok(match code {
            0 => (self.fresh(), true),
            15 => (self.explicit()?, true),
            _ => (self.vertices.get(usize::from(code) - 1)?, false),
        })
    }

    fn fresh(&mut self) -> u32 {
        let vertex = self.next;
        self.next = vertex.wrapping_add(1);
        vertex
    }

    fn near(&mut self, step: u32) -> u32 {
        self.last = self.last.wrapping_add(step);
        self.last
    }

    fn explicit(&mut self) -> Result<u32, Problem> {
        let step = unzigzag(self.data.varint()?);
        Ok(self.near(step))
    }
}

/// Decode `count` indices of any kind: each is a difference to one of two that came before.
pub(super) fn sequence(bytes: &[u8], count: usize) -> Result<Vec<u32>, Problem> {
    let (header, mut stream, _) = Stream::split(bytes, 4)?;
    if header != 0xD1 {
        return Err("it is no stream of indices");
    }
    let mut last = [0_u32; 2];
    let indices = (0..count).map(|_| {
        let value = stream.varint()?;
        let last = &mut last[value as usize & 1];
        *last = last.wrapping_add(unzigzag(value >> 1));
        Ok(*last)
    });
    let indices = indices.collect::<Result<_, Problem>>()?;
    stream.end()?;
    Ok(indices)
}
