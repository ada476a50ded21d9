//! The serialiser.

use super::Data;
use crate::emit::literal::number;
use serde::ser::{
    Error, Impossible, Serialize, SerializeSeq, SerializeStruct, SerializeStructVariant,
    SerializeTuple, SerializeTupleStruct, SerializeTupleVariant, Serializer,
};
use std::fmt::{self, Display};

/// Variants that box what they hold, which Serde does not tell.
const BOXED: [(&str, &str); 1] = [("Law", "Muscle")];

/// Enumerations whose variants are so frequent that they stand without its name.
const BARE: [&str; 1] = ["Number"];

/// Makes [`Data`].
pub(super) struct Serial;

/// What there is no data for.
#[derive(Debug)]
pub(super) struct Unwritable(String);

impl Display for Unwritable {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for Unwritable {}

impl Error for Unwritable {
    fn custom<T: Display>(message: T) -> Self {
        Unwritable(message.to_string())
    }
}

type Made = Result<Data, Unwritable>;

/// A sequence on its way, and what is made of it in the end.
pub(super) struct Sequence {
    items: Vec<Data>,
    end: fn(String, Vec<Data>) -> Data,
    name: String,
}

/// Named fields on their way.
pub(super) struct Named {
    name: String,
    fields: Vec<(&'static str, Data)>,
}

impl Sequence {
    fn new(name: String, end: fn(String, Vec<Data>) -> Data) -> Self {
        Sequence { items: Vec::new(), end, name }
    }
    fn push(&mut self, value: &(impl Serialize + ?Sized)) -> Result<(), Unwritable> {
        self.items.push(value.serialize(Serial)?);
        Ok(())
    }
    fn finish(self) -> Made {
        Ok((self.end)(self.name, self.items))
    }
}

fn path(name: &str, variant: &str) -> String {
    if BARE.contains(&name) { variant.to_owned() } else { format!("{name}::{variant}") }
}

macro_rules! plain {
    ($($method:ident: $of:ty;)*) => {$(
        fn $method(self, value: $of) -> Made {
            Ok(Data::Plain(value.to_string()))
        }
    )*};
}

impl Serializer for Serial {
    type Ok = Data;
    type Error = Unwritable;
    type SerializeSeq = Sequence;
    type SerializeTuple = Sequence;
    type SerializeTupleStruct = Sequence;
    type SerializeTupleVariant = Sequence;
    type SerializeMap = Impossible<Data, Unwritable>;
    type SerializeStruct = Named;
    type SerializeStructVariant = Named;

    plain! {
        serialize_bool: bool;
        serialize_i8: i8;
        serialize_i16: i16;
        serialize_i32: i32;
        serialize_i64: i64;
        serialize_u8: u8;
        serialize_u16: u16;
        serialize_u32: u32;
        serialize_u64: u64;
    }

    fn serialize_f32(self, value: f32) -> Made {
        self.serialize_f64(value.into())
    }
    fn serialize_f64(self, value: f64) -> Made {
        Ok(Data::Plain(number(value).to_string().replace(' ', "")))
    }
    fn serialize_char(self, value: char) -> Made {
        Ok(Data::Plain(format!("{value:?}")))
    }
    fn serialize_str(self, value: &str) -> Made {
        Ok(Data::Text(value.to_owned()))
    }
    fn serialize_bytes(self, _: &[u8]) -> Made {
        Err(Unwritable("bytes".into()))
    }
    fn serialize_none(self) -> Made {
        Ok(Data::Option(None))
    }
    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Made {
        Ok(Data::Option(Some(Box::new(value.serialize(Serial)?))))
    }
    fn serialize_unit(self) -> Made {
        Ok(Data::Tuple(Vec::new()))
    }
    fn serialize_unit_struct(self, name: &'static str) -> Made {
        Ok(Data::Call(name.into(), Vec::new()))
    }
    fn serialize_unit_variant(self, name: &str, _: u32, variant: &str) -> Made {
        Ok(Data::Call(path(name, variant), Vec::new()))
    }
    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, name: &str, value: &T) -> Made {
        Ok(Data::Call(name.into(), vec![value.serialize(Serial)?]))
    }
    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        name: &str,
        _: u32,
        variant: &str,
        value: &T,
    ) -> Made {
        let mut inner = value.serialize(Serial)?;
        if BOXED.contains(&(name, variant)) {
            inner = Data::Call("Box::new".into(), vec![inner]);
        }
        Ok(Data::Call(path(name, variant), vec![inner]))
    }
    fn serialize_seq(self, _: Option<usize>) -> Result<Sequence, Unwritable> {
        Ok(Sequence::new(String::new(), |_, items| Data::List(items)))
    }
    fn serialize_tuple(self, _: usize) -> Result<Sequence, Unwritable> {
        Ok(Sequence::new(String::new(), |_, items| Data::Tuple(items)))
    }
    fn serialize_tuple_struct(self, name: &str, _: usize) -> Result<Sequence, Unwritable> {
        Ok(Sequence::new(name.into(), Data::Call))
    }
    fn serialize_tuple_variant(
        self,
        name: &str,
        _: u32,
        variant: &str,
        _: usize,
    ) -> Result<Sequence, Unwritable> {
        Ok(Sequence::new(path(name, variant), Data::Call))
    }
    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Unwritable> {
        Err(Unwritable("a map".into()))
    }
    fn serialize_struct(self, name: &str, _: usize) -> Result<Named, Unwritable> {
        Ok(Named { name: name.into(), fields: Vec::new() })
    }
    fn serialize_struct_variant(
        self,
        name: &str,
        _: u32,
        variant: &str,
        _: usize,
    ) -> Result<Named, Unwritable> {
        Ok(Named { name: path(name, variant), fields: Vec::new() })
    }
}

macro_rules! sequences {
    ($($trait:ident $method:ident;)*) => {$(
        impl $trait for Sequence {
            type Ok = Data;
            type Error = Unwritable;
            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unwritable> {
                self.push(value)
            }
            fn end(self) -> Made {
                self.finish()
            }
        }
    )*};
}

sequences! {
    SerializeSeq serialize_element;
    SerializeTuple serialize_element;
    SerializeTupleStruct serialize_field;
    SerializeTupleVariant serialize_field;
}

macro_rules! named {
    ($($trait:ident)*) => {$(
        impl $trait for Named {
            type Ok = Data;
            type Error = Unwritable;
            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                key: &'static str,
                value: &T,
            ) -> Result<(), Unwritable> {
                self.fields.push((key, value.serialize(Serial)?));
                Ok(())
            }
            fn end(self) -> Made {
                Ok(Data::Fields(self.name, self.fields))
            }
        }
    )*};
}

named!(SerializeStruct SerializeStructVariant);
