// The form of JSON values, said once: a form reads and checks a value, writes it, and describes it as JSON Schema.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <type_traits>

#include "traces/files/json_cursor.h"

namespace beampipe {

// How a T stands in JSON.
template <class T>
struct Form {
  Json schema;  // a JSON Schema without a description
  // Throws TraceError if the value at a place has another form. What it leaves out keeps its value.
  std::function<void(const JsonCursor& at, T& value)> read;
  std::function<Json(const T& value)> write = {};  // empty where nothing is written from Json
  // Reads back what was written, by this program or by an older one: other keys may be there. Throws JsonError. Empty
  // for numbers and texts, and where nothing is read back.
  std::function<void(const Json& json, T& value)> take = {};

  T operator()(const JsonCursor& at) const {
    T value{};
    read(at, value);
    return value;
  }
};

// Form::take of any form.
template <class T>
std::function<void(const Json& json, T& value)> taker_of(const Form<T>& form) {
  if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    return [](const Json& json, T& value) { value = json.get<T>(); };
  } else {
    return form.take;
  }
}

// What the value of a key means, beside its form.
Json described(Json schema, const std::string& meaning);

// A JSON Schema as a file of its own.
Json schema_file(const Json& schema, const std::string& title);

// A member of an object.
template <class T>
struct Field {
  std::string key, meaning;
  bool required = true;
  Json schema = {};
  std::function<void(const JsonCursor& at, T& object)> read = {};
  std::function<Json(const T& object)> get = {};               // empty where nothing is written from Json
  std::function<bool(const T& object)> is_left_out = {};       // empty: it is always written
  std::function<void(const Json& json, T& object)> take = {};  // empty where it is not read back
  bool may_lack = false;  // what was written may be without it, although it is always written now
};

// The form of objects, as a list of their members: of each the key, where it stands in a T (a pointer to a member, or a
// function that gives a reference), its form and its meaning.
template <class T>
class ObjectForm {
 public:
  explicit ObjectForm(std::string keys = "") : keys_(std::move(keys)) {}

  template <class Place, class Value>
  ObjectForm& required(const std::string& key, Place place, const Form<Value>& form, const std::string& meaning) {
    Field<T> field{key, meaning, true, form.schema};
    field.read = [place, read = form.read](const JsonCursor& at, T& object) { read(at, std::invoke(place, object)); };
    if (form.write)
      field.get = [place, write = form.write](const T& object) { return write(std::invoke(place, object)); };
    return add(std::move(field));
  }

  // It may be left out. A T has a Value with a default, or a std::optional of one.
  template <class Place, class Value>
  ObjectForm& optional(const std::string& key, Place place, const Form<Value>& form, const std::string& meaning) {
    using Stored = std::remove_cvref_t<std::invoke_result_t<Place, T&>>;
    if constexpr (std::is_same_v<Stored, Value>) {
      required(key, place, form, meaning);
      Field<T>& field = fields_.back();
      field.is_left_out = [place](const T& object) {
        static const T defaults{};
        return std::invoke(place, object) == std::invoke(place, defaults);
      };
      const Json value = field.get ? field.get(T{}) : Json();
      if (!value.is_null() && !value.is_object() && !(value.is_array() && value.size() == 0))
        field.schema["default"] = value;
    } else {
      Field<T> field{key, meaning, true, form.schema};
      field.read = [place, read = form.read](const JsonCursor& at, T& object) {
        read(at, std::invoke(place, object).emplace());
      };
      if (form.write)
        field.get = [place, write = form.write](const T& object) { return write(*std::invoke(place, object)); };
      field.is_left_out = [place](const T& object) { return !std::invoke(place, object); };
      add(std::move(field));
    }
    fields_.back().required = false;
    return *this;
  }

  // It is written, and read back by Form::take if `place` is a pointer to a member, or has a `ref` that gives a
  // reference. `place` gives a Value, or a std::optional of one, which may be left out.
  template <class Place, class Value>
  ObjectForm& written(const std::string& key, Place place, const Form<Value>& form, const std::string& meaning) {
    using Stored = std::remove_cvref_t<std::invoke_result_t<Place, const T&>>;
    Field<T> field{key, meaning, true, form.schema};
    if constexpr (std::is_same_v<Stored, std::optional<Value>>) {
      field.required = false;
      field.get = [place, write = form.write](const T& object) { return write(*std::invoke(place, object)); };
      field.is_left_out = [place](const T& object) { return !std::invoke(place, object); };
    } else {
      field.get = [place, write = form.write](const T& object) { return write(std::invoke(place, object)); };
    }
    if constexpr (std::is_member_object_pointer_v<Place>) {
      field.take = [place, take = taker_of(form)](const Json& json, T& object) {
        take_into<Value>(take, json, object.*place);
      };
    } else if constexpr (requires(T & object) { place.ref(object); }) {
      field.take = [place, take = taker_of(form)](const Json& json, T& object) {
        take_into<Value>(take, json, place.ref(object));
      };
    }
    return add(std::move(field));
  }

  // How the last member is read back, where its place does not say it.
  ObjectForm& taken(std::function<void(const Json& json, T& object)> take) {
    fields_.back().take = std::move(take);
    return *this;
  }

  // Older programs did not write the last member.
  ObjectForm& may_lack() {
    fields_.back().may_lack = true;
    return *this;
  }

  // It is described only; what writes the object adds it.
  ObjectForm& added(const std::string& key, const Json& schema, const std::string& meaning) {
    return add({key, meaning, false, schema});
  }

  ObjectForm& add(Field<T> field) {
    fields_.push_back(std::move(field));
    return *this;
  }

  // What the members must be together, checked after all of them.
  ObjectForm& check(std::function<void(const JsonCursor& at, T& object)> check) {
    checks_.push_back(std::move(check));
    return *this;
  }

  // Forms are copied into those of what holds them, so their functions share the fields.
  operator Form<T>() const {
    const auto self = std::make_shared<const ObjectForm>(*this);
    return {schema(), reader(self), writer(self), taker(self)};
  }

 private:
  Json schema() const {
    Json required = Json::array(), properties = Json::object();
    for (const Field<T>& field : fields_) {
      if (field.required) required.push_back(field.key);
      properties[field.key] = described(field.schema, field.meaning);
    }
    Json schema = {{"type", "object"}};
    if (required.size() > 0) schema["required"] = required;
    schema["additionalProperties"] = false;
    schema["properties"] = properties;
    return schema;
  }

  std::vector<std::string> required() const {
    std::vector<std::string> keys;
    for (const Field<T>& field : fields_)
      if (field.required) keys.push_back(field.key);
    return keys;
  }

  using Shared = std::shared_ptr<const ObjectForm>;

  static auto reader(const Shared& self) {
    std::vector<std::string_view> known;
    for (const Field<T>& field : self->fields_) known.push_back(field.key);
    return [self, known](const JsonCursor& at, T& object) {
      at.expect_keys(known, self->keys_);
      for (const Field<T>& field : self->fields_) {
        if (field.required) {
          if (!at.has(field.key)) at.expect_all(self->required());
          field.read(at[field.key], object);
        } else if (const auto value = at.find(field.key)) {
          field.read(*value, object);
        }
      }
      for (const auto& check : self->checks_) check(at, object);
    };
  }

  static auto writer(const Shared& self) {
    return [self](const T& object) {
      Json json = Json::object();
      for (const Field<T>& field : self->fields_)
        if (field.get && !(field.is_left_out && field.is_left_out(object))) json[field.key] = field.get(object);
      return json;
    };
  }

  template <class Value, class Take, class Stored>
  static void take_into(const Take& take, const Json& json, Stored& stored) {
    if constexpr (std::is_same_v<Stored, std::optional<Value>>) {
      take(json, stored.emplace());
    } else if constexpr (std::is_same_v<Stored, Value>) {
      take(json, stored);
    } else {
      stored = json.get<Stored>();  // another type of integer
    }
  }

  static auto taker(const Shared& self) {
    return [self](const Json& json, T& object) {
      for (const Field<T>& field : self->fields_) {
        if (!field.take) continue;
        const Json* const value = field.required && !field.may_lack ? &json.at(field.key) : json.find(field.key);
        if (value) field.take(*value, object);
      }
    };
  }

  std::string keys_;  // how errors call the keys; empty: they list them
  std::vector<Field<T>> fields_;
  std::vector<std::function<void(const JsonCursor&, T&)>> checks_;
};

// Forms of values, by what errors say that is expected.
namespace form {

Form<bool> boolean();
Form<std::string> text();
Form<std::string> text(const std::string& meaning);  // which must not be empty
Form<std::string> one_of(const std::vector<std::string>& names);
Form<double> number();
Form<double> number(double low, double high);          // low..high
Form<double> number_between(double low, double high);  // low < number < high
Form<float> real(float low, float high);               // low..high
Form<float> fraction();                                // 0..1
Form<std::uint32_t> integer(std::uint32_t low, std::uint32_t high);
Form<std::uint32_t> power_of_two(std::uint32_t low, std::uint32_t high);
Form<std::uint32_t> version(std::uint32_t number);

// The names of enumerators, in their order.
template <class Enum>
Form<Enum> choice(std::span<const std::string_view> names) {
  Json schema;
  for (const std::string_view name : names) schema["enum"].push_back(name);
  return {schema, [names](const JsonCursor& at, Enum& value) { value = Enum(at.choice(names)); },
          [names](const Enum& value) { return Json(names[static_cast<std::size_t>(value)]); }};
}

// `one`: what there must be one of at least, such as "frame"; empty: there may be none.
template <class Value>
Form<std::vector<Value>> list(const Form<Value>& element, const std::string& one = "") {
  Json schema = {{"type", "array"}, {"items", element.schema}};
  if (!one.empty()) schema["minItems"] = 1;
  return {schema,
          [read = element.read, one](const JsonCursor& at, std::vector<Value>& values) {
            for (const JsonCursor& each : at.elements()) read(each, values.emplace_back());
            if (values.empty() && !one.empty()) at.fail("at least one " + one, "none");
          },
          [write = element.write](const std::vector<Value>& values) {
            Json json = Json::array();
            for (const Value& value : values) json.push_back(write(value));
            return json;
          },
          [take = taker_of(element)](const Json& json, std::vector<Value>& values) {
            for (const Json& each : json.elements()) take(each, values.emplace_back());
          }};
}

Form<glm::dvec3> vec3();
Form<glm::vec3> color();  // each 0..kMostColor
Form<glm::vec4> rgba();   // the same, and alpha 0..1
Form<glm::dmat4> matrix();

// Of what is only written.
Form<std::uint64_t> count(std::uint64_t least = 0);
Form<double> amount();  // 0 and up
Form<Json> as_it_is(const Json& schema);

// An array of this length.
Json array_schema(const Json& element, int length);

template <class Vector>
Form<Vector> vector() {
  return {array_schema({{"type", "number"}}, Vector::length()), {}, [](const Vector& vector) {
            Json json = Json::array();
            for (int i = 0; i < vector.length(); ++i) json.push_back(vector[i]);
            return json;
          }};
}

template <class Value>
Form<std::map<std::string, Value>> by_name(const Form<Value>& element) {
  return {{{"type", "object"}, {"additionalProperties", element.schema}},
          {},
          [write = element.write](const std::map<std::string, Value>& values) {
            Json json = Json::object();
            for (const auto& [name, value] : values) json[name] = write(value);
            return json;
          },
          [take = taker_of(element)](const Json& json, std::map<std::string, Value>& values) {
            for (const auto& [name, value] : json.members()) take(value, values[name]);
          }};
}

// The place of a text or list as an optional one, which is left out if it is empty.
template <class T, class Value>
auto filled(Value T::*member) {
  return [member](const T& object) {
    return (object.*member).empty() ? std::nullopt : std::optional<Value>(object.*member);
  };
}

// An object whose keys are names that the user chooses, and which the values keep.
template <class Value>
Form<std::vector<Value>> named(const Form<Value>& element, std::string Value::*name, const std::string& one = "") {
  Json schema = {{"type", "object"}, {"additionalProperties", element.schema}};
  if (!one.empty()) schema["minProperties"] = 1;
  return {schema, [read = element.read, name, one](const JsonCursor& at, std::vector<Value>& values) {
            for (const auto& [key, value] : at.members()) {
              values.emplace_back().*name = key;
              read(value, values.back());
            }
            if (values.empty() && !one.empty()) at.fail("at least one " + one, "none");
          }};
}

// An object of values of the same form under given keys, all of which must be there, or none. `called`: as for
// ObjectForm.
struct Key {
  std::string key, meaning;
};
template <class Value>
Form<std::map<std::string, Value>> record(const std::vector<Key>& keys, bool required, const Form<Value>& form,
                                          const std::string& called = "") {
  using Values = std::map<std::string, Value>;
  ObjectForm<Values> object(called);
  for (const auto& [key, meaning] : keys)
    object.add({key, meaning, required, form.schema,
                [key = key, read = form.read](const JsonCursor& at, Values& values) { read(at, values[key]); }});
  return object;
}

// A form of which only the shape is checked.
template <class T, class Value>
Field<T> unused(const std::string& key, bool required, const Form<Value>& form, const std::string& meaning) {
  return {key, meaning, required, form.schema, [read = form.read](const JsonCursor& at, T&) {
            Value value{};
            read(at, value);
          }};
}

}  // namespace form
}  // namespace beampipe
