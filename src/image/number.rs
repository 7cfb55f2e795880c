//! Types of numbers in files of bare numbers.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberType {
    F32,
    F64,
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
}

/// Files that name types of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Scene,
    Npy,
    Ply,
    Nrrd,
    MetaImage,
}

impl NumberType {
    /// All of them, with their names in each [`Format`], in its order; several names are parted by bars.
    const NAMES: [(NumberType, [&str; 5]); 8] = [
        (Self::F32, ["f32", "f4", "float|float32", "float", "MET_FLOAT"]),
        (Self::F64, ["f64", "f8", "double|float64", "double", "MET_DOUBLE"]),
        (Self::U8, ["u8", "u1", "uchar|uint8", "uchar|unsigned char|uint8|uint8_t", "MET_UCHAR"]),
        (Self::I8, ["i8", "i1", "char|int8", "signed char|int8|int8_t", "MET_CHAR"]),
        (
            Self::U16,
            ["u16", "u2", "ushort|uint16", "ushort|unsigned short|unsigned short int|uint16|uint16_t", "MET_USHORT"],
        ),
        (
            Self::I16,
            ["i16", "i2", "short|int16", "short|short int|signed short|signed short int|int16|int16_t", "MET_SHORT"],
        ),
        (Self::U32, ["u32", "u4", "uint|uint32", "uint|unsigned int|uint32|uint32_t", "MET_UINT"]),
        (Self::I32, ["i32", "i4", "int|int32", "int|signed int|int32|int32_t", "MET_INT"]),
    ];

    /// The type of this name.
    pub fn named(name: &str, format: Format) -> Option<NumberType> {
        let is_so_called = |names: &[&str; 5]| names[format as usize].split('|').any(|known| known == name);
        Self::NAMES.iter().find(|(_, names)| is_so_called(names)).map(|(number, _)| *number)
    }

    /// The names of scene files.
    pub fn names() -> [&'static str; 8] {
        Self::NAMES.map(|(_, names)| names[Format::Scene as usize])
    }

    pub fn is_whole(self) -> bool {
        !matches!(self, NumberType::F32 | NumberType::F64)
    }

    /// Bytes of a number.
    pub fn size(self) -> usize {
        match self {
            NumberType::U8 | NumberType::I8 => 1,
            NumberType::U16 | NumberType::I16 => 2,
            NumberType::F32 | NumberType::U32 | NumberType::I32 => 4,
            NumberType::F64 => 8,
        }
    }

    /// The number in so many bytes.
    #[inline]
    pub fn read(self, bytes: &[u8], big_endian: bool) -> f64 {
        fn ordered<const N: usize>(bytes: &[u8], big_endian: bool) -> [u8; N] {
            let mut own = [0; N];
            own.copy_from_slice(bytes);
            if big_endian {
                own.reverse();
            }
            own
        }
        match self {
            NumberType::U8 => bytes[0].into(),
            NumberType::I8 => (bytes[0] as i8).into(),
            NumberType::U16 => u16::from_le_bytes(ordered(bytes, big_endian)).into(),
            NumberType::I16 => i16::from_le_bytes(ordered(bytes, big_endian)).into(),
            NumberType::U32 => u32::from_le_bytes(ordered(bytes, big_endian)).into(),
            NumberType::I32 => i32::from_le_bytes(ordered(bytes, big_endian)).into(),
            NumberType::F32 => f32::from_le_bytes(ordered(bytes, big_endian)).into(),
            NumberType::F64 => f64::from_le_bytes(ordered(bytes, big_endian)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::NumberType;

    #[test]
    fn numbers_are_read_in_either_byte_order() {
        for x in [0.0f64, -1.5, f64::INFINITY, f64::MIN_POSITIVE, 1.0 / 3.0] {
            assert_eq!(NumberType::F64.read(&x.to_le_bytes(), false), x);
            assert_eq!(NumberType::F64.read(&x.to_be_bytes(), true), x);
            assert_eq!(NumberType::F32.read(&(x as f32).to_le_bytes(), false), f64::from(x as f32));
            assert_eq!(NumberType::F32.read(&(x as f32).to_be_bytes(), true), f64::from(x as f32));
        }
        assert_eq!([NumberType::U8, NumberType::I8].map(|n| n.read(&[200], true)), [200.0, -56.0]);
        assert_eq!(NumberType::U16.read(&65_000u16.to_be_bytes(), true), 65_000.0);
        assert_eq!(NumberType::I16.read(&(-1024i16).to_be_bytes(), true), -1024.0);
        assert_eq!(NumberType::U32.read(&4_000_000_000u32.to_le_bytes(), false), 4e9);
        assert_eq!(NumberType::I32.read(&(-2_000_000_000i32).to_le_bytes(), false), -2e9);
    }
}
