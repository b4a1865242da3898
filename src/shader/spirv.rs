//! The little of SPIR-V's binary form that our passes need.

/// Words before the first instruction.
pub(super) const HEADER_WORDS: usize = 5;

/// Opcodes, SPIR-V specification section 3.42.
pub(super) mod op {
    pub(in crate::shader) const SOURCE_CONTINUED: u16 = 2;
    pub(in crate::shader) const SOURCE: u16 = 3;
    pub(in crate::shader) const SOURCE_EXTENSION: u16 = 4;
    pub(in crate::shader) const NAME: u16 = 5;
    pub(in crate::shader) const MEMBER_NAME: u16 = 6;
    pub(in crate::shader) const STRING: u16 = 7;
    pub(in crate::shader) const LINE: u16 = 8;
    pub(in crate::shader) const EXTENSION: u16 = 10;
    pub(in crate::shader) const EXT_INST_IMPORT: u16 = 11;
    pub(in crate::shader) const MEMORY_MODEL: u16 = 14;
    pub(in crate::shader) const ENTRY_POINT: u16 = 15;
    pub(in crate::shader) const EXECUTION_MODE: u16 = 16;
    pub(in crate::shader) const CAPABILITY: u16 = 17;
    pub(in crate::shader) const FUNCTION: u16 = 54;
    pub(in crate::shader) const FUNCTION_END: u16 = 56;
    pub(in crate::shader) const DECORATE: u16 = 71;
    pub(in crate::shader) const MEMBER_DECORATE: u16 = 72;
    pub(in crate::shader) const F_NEGATE: u16 = 127;
    pub(in crate::shader) const F_ADD: u16 = 129;
    pub(in crate::shader) const F_SUB: u16 = 131;
    pub(in crate::shader) const F_MUL: u16 = 133;
    pub(in crate::shader) const F_DIV: u16 = 136;
    pub(in crate::shader) const F_REM: u16 = 140;
    pub(in crate::shader) const F_MOD: u16 = 141;
    pub(in crate::shader) const VECTOR_TIMES_SCALAR: u16 = 142;
    pub(in crate::shader) const MATRIX_TIMES_SCALAR: u16 = 143;
    pub(in crate::shader) const VECTOR_TIMES_MATRIX: u16 = 144;
    pub(in crate::shader) const MATRIX_TIMES_VECTOR: u16 = 145;
    pub(in crate::shader) const MATRIX_TIMES_MATRIX: u16 = 146;
    pub(in crate::shader) const OUTER_PRODUCT: u16 = 147;
    pub(in crate::shader) const DOT: u16 = 148;
    pub(in crate::shader) const NO_LINE: u16 = 317;
    pub(in crate::shader) const MODULE_PROCESSED: u16 = 330;
}

/// One instruction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instruction<'a> {
    /// Index of its first word in the module.
    pub(super) at: usize,
    pub(super) opcode: u16,
    /// All its words, the opcode's included.
    pub(super) words: &'a [u32],
}

impl Instruction<'_> {
    /// The literal string that begins at word `index`.
    pub(super) fn string(&self, index: usize) -> String {
        let words = self.words.get(index..).unwrap_or_default();
        let bytes = words.iter().flat_map(|w| w.to_le_bytes());
        let text: Vec<u8> = bytes.take_while(|b| *b != 0).collect();
        String::from_utf8_lossy(&text).into_owned()
    }
}

/// Walks a module; ends early if the words are not well-formed.
pub(super) fn instructions(words: &[u32]) -> impl Iterator<Item = Instruction<'_>> {
    let mut at = HEADER_WORDS;
    std::iter::from_fn(move || {
        let first = *words.get(at)?;
        let length = (first >> 16) as usize;
        let instruction = Instruction {
            at,
            opcode: (first & 0xffff) as u16,
            words: words.get(at..at + length.max(1))?,
        };
        at += length.max(1);
        Some(instruction)
    })
}

/// The module without the names and sources that only people read.
pub(super) fn strip_debug(words: &[u32]) -> Vec<u32> {
    let debug = [
        op::SOURCE_CONTINUED,
        op::SOURCE,
        op::SOURCE_EXTENSION,
        op::NAME,
        op::MEMBER_NAME,
        op::STRING,
        op::LINE,
        op::NO_LINE,
        op::MODULE_PROCESSED,
    ];
    let kept = instructions(words).filter(|i| !debug.contains(&i.opcode));
    let body = kept.flat_map(|i| i.words.iter().copied());
    words
        .iter()
        .take(HEADER_WORDS)
        .copied()
        .chain(body)
        .collect()
}
