"""Counts the instructions of a SPIR-V module by class. Opcodes are those of the SPIR-V 1.3 specification, section 3.32."""

from collections import Counter

MAGIC = 0x07230203
EXT_INST, FUNCTION, FUNCTION_END, CALL, VARIABLE, LOAD, STORE = 12, 54, 56, 57, 59, 61, 62
NAME, TYPE_INT, TYPE_FLOAT, TYPE_VECTOR, TYPE_MATRIX = 5, 21, 22, 23, 24
TYPE_ARRAY, TYPE_STRUCT, TYPE_POINTER, CONSTANT = 28, 30, 32, 43
ACCESS_CHAINS = (65, 66)
STORAGE = {0: "constant", 1: "input", 2: "buffer", 4: "workgroup", 6: "private", 7: "private", 12: "buffer"}

# First and last opcode of each class.
RANGES = [
    ("move", 77, 84),
    ("convert", 109, 124),
    ("integer", 126, 126),
    ("integer", 149, 152),
    ("logic", 154, 191),
    ("integer", 194, 205),
    ("atomic", 227, 242),
    ("branch", 250, 251),
]
FLOAT = {127, 129, 131, 133, 136, 140, 141, *range(142, 149)}
INTEGER = {128, 130, 132, 134, 135, 137, 138, 139}
# GLSL.std.450.
TRANSCENDENTAL = {*range(13, 33)}
INTEGER_EXT = {5, 7, 38, 39, 41, 42, 44, 45, 73, 74, 75}

CLASSES = ["float", "integer", "logic", "transcendental", "convert", "move", "branch", "atomic"]
MEMORY = ["load buffer", "store buffer", "load workgroup", "store workgroup"]
# What an arithmetic unit has to do, as opposed to what a compiler may resolve into registers.
ARITHMETIC = ["float", "integer", "logic", "transcendental", "convert"]


class Module:
    """A module with the names of its functions (`etendue render --spirv`)."""

    def __init__(self, data):
        words = memoryview(data).cast("I")
        if len(words) < 5 or words[0] != MAGIC:
            raise ValueError("not a SPIR-V module in this machine's byte order")
        self.names, self.types, self.constants, self.variables = {}, {}, {}, {}
        self.functions, self.results, self.totals = {}, {}, {}
        self.read(words)

    def read(self, words):
        at, body = 5, None
        while at < len(words):
            code, count = words[at] & 0xFFFF, words[at] >> 16
            operands = list(words[at + 1 : at + count])
            if code == NAME:
                text = b"".join(word.to_bytes(4, "little") for word in operands[1:])
                self.names[operands[0]] = text.split(b"\0")[0].decode()
            elif TYPE_INT - 2 <= code <= TYPE_POINTER:
                self.types[operands[0]] = (code, operands[1:])
            elif code == CONSTANT:
                self.constants[operands[1]] = operands[2]
            elif code == FUNCTION:
                body = self.functions[operands[1]] = []
            elif code == FUNCTION_END:
                body = None
            if code == VARIABLE:
                self.variables[operands[1]] = (operands[0], operands[2])
            if code in (VARIABLE, *ACCESS_CHAINS):
                self.results[operands[1]] = operands[0]
            if body is not None:
                body.append((code, operands))
            at += count

    def function(self, name):
        """The number of the only function of this name, or None."""
        found = [number for number in self.functions if self.names.get(number) == name]
        return found[0] if len(found) == 1 else None

    def bytes_of(self, kind):
        """Of a type, without padding but that of arrays of three-vectors."""
        code, rest = self.types[kind]
        if code in (TYPE_INT, TYPE_FLOAT):
            return rest[0] // 8
        if code in (TYPE_VECTOR, TYPE_MATRIX):
            return rest[1] * self.bytes_of(rest[0])
        if code == TYPE_ARRAY:
            return self.constants[rest[1]] * self.bytes_of(rest[0])
        if code == TYPE_STRUCT:
            return sum(map(self.bytes_of, rest))
        return 4

    def components(self, kind):
        """Scalars in a type: what a vector operation does."""
        code, rest = self.types[kind]
        return rest[1] * self.components(rest[0]) if code in (TYPE_VECTOR, TYPE_MATRIX) else 1

    def variable_bytes(self, storage):
        """Of the variables of a storage class outside and inside functions."""
        pointed = [self.types[kind][1][1] for kind, where in self.variables.values() if STORAGE.get(where) == storage]
        return sum(map(self.bytes_of, pointed))

    def count(self, number):
        """Scalar operations and accesses of a function, those that it calls included: each instruction once,
        whatever loops and branches do. Bytes of accesses are under "load buffer bytes" and the like."""
        if number not in self.totals:
            total = Counter()
            for code, operands in self.functions[number]:
                total.update(self.count(operands[2]) if code == CALL else self.cost(code, operands))
            self.totals[number] = total
        return self.totals[number]

    def cost(self, code, operands):
        if code in (LOAD, STORE):
            return self.access(code, operands)
        name = class_of(code, operands)
        if name is None:
            return {}
        wide = name not in ("branch", "atomic") and operands[0] in self.types
        return {name: self.components(operands[0]) if wide else 1}

    def access(self, code, operands):
        pointer = operands[2] if code == LOAD else operands[0]
        # A parameter of a function points to what its caller holds.
        kind = self.types[self.results[pointer]][1] if pointer in self.results else [7, None]
        name = f"{'load' if code == LOAD else 'store'} {STORAGE.get(kind[0], 'other')}"
        return {name: 1, f"{name} bytes": self.bytes_of(kind[1]) if kind[1] else 0}


def class_of(code, operands):
    """The class of an instruction that computes or branches, else None."""
    if code == EXT_INST:
        kind = operands[3]
        return "transcendental" if kind in TRANSCENDENTAL else "integer" if kind in INTEGER_EXT else "float"
    if code in FLOAT:
        return "float"
    if code in INTEGER:
        return "integer"
    return next((name for name, first, last in RANGES if first <= code <= last), None)
