//! Closed lists of words: an enum whose members have one name each, under which they are stored, stated and printed.

/// Makes such an enum, with `ALL`, `key`, `from_key`, the forms of serde and the schema, so that every name is stated once; where each
/// word has a label for people behind `=>`, with `label` too.
#[macro_export]
macro_rules! string_enum {
    ($(#[$about:meta])* pub enum $name:ident {
        $($(#[$of:meta])* $word:ident = $key:literal => $label:literal),+ $(,)?
    }) => {
        $crate::string_enum! { $(#[$about])* pub enum $name { $($(#[$of])* $word = $key),+ } }

        impl $name {
            /// In words, for people.
            pub const fn label(self) -> &'static str {
                match self {
                    $($name::$word => $label),+
                }
            }
        }
    };
    ($(#[$about:meta])* pub enum $name:ident {
        $($(#[$of:meta])* $word:ident = $key:literal),+ $(,)?
    }) => {
        $(#[$about])*
        #[derive(schemars::JsonSchema)]
        pub enum $name {
            $($(#[$of])* #[schemars(rename = $key)] $word),+
        }

        impl $name {
            /// Every one, in the order of the list.
            pub const ALL: [$name; [$($key),+].len()] = [$($name::$word),+];

            /// Name under which it is stored and stated.
            pub const fn key(self) -> &'static str {
                match self {
                    $($name::$word => $key),+
                }
            }

            /// The one of that name.
            pub fn from_key(key: &str) -> Option<$name> {
                $name::ALL.into_iter().find(|word| word.key() == key)
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.key())
            }
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<$name, D::Error> {
                let key = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
                $name::from_key(&key).ok_or_else(|| serde::de::Error::unknown_variant(&key, &[$($key),+]))
            }
        }
    };
}

#[cfg(test)]
mod tests {
    crate::string_enum! {
        /// Colours of a litmus paper.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Litmus {
            /// Acid.
            Red = "red" => "acid",
            /// Base.
            Blue = "blue" => "base",
        }
    }

    #[test]
    fn each_name_leads_there_and_back() {
        for word in Litmus::ALL {
            assert_eq!(Litmus::from_key(word.key()), Some(word));
            let text = serde_json::to_string(&word).unwrap();
            assert_eq!(serde_json::from_str::<Litmus>(&text).unwrap(), word);
        }
        assert_eq!(Litmus::Blue.label(), "base");
        let wrong = serde_json::from_str::<Litmus>("\"green\"")
            .unwrap_err()
            .to_string();
        assert!(wrong.contains("expected `red` or `blue`"), "{wrong}");
    }
}
