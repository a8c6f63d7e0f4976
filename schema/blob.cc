#include "schema/blob.h"

#include <bit>

#include "schema/array_form.h"

namespace cairn {

static_assert(std::endian::native == std::endian::little,
              "arrays are hashed and stored as they lie in memory");

const Array& Blob::at(std::string_view name) const {
  const auto it = fields_.find(name);
  if (it == fields_.end()) throw InputError("there is no '" + std::string(name) + "'");
  return it->second;
}

const Array& Blob::Checked(std::string_view name, DType type) const {
  const Array& array = at(name);
  if (array.type() != type) {
    throw InputError("'" + std::string(name) + "' holds " + DTypeName(array.type()) + " where " +
                     DTypeName(type) + " is needed");
  }
  return array;
}

std::vector<std::string> Blob::Texts(std::string_view name) const {
  return Checked(name, DType::kText).AsTexts();
}

std::string Blob::Text(std::string_view name) const {
  std::vector<std::string> texts = Texts(name);
  if (texts.size() != 1) throw InputError("'" + std::string(name) + "' is not a single text");
  return texts[0];
}

void Blob::Put(std::string name, Array array) { fields_.insert_or_assign(std::move(name), std::move(array)); }

void Blob::PutAll(const std::string& prefix, const Blob& other) {
  for (const auto& [name, array] : other.fields_) Put(prefix + name, array);
}

Blob Blob::Sub(std::string_view prefix) const {
  Fields sub;
  for (auto it = fields_.lower_bound(prefix); it != fields_.end() && it->first.starts_with(prefix); ++it) {
    sub.emplace(it->first.substr(prefix.size()), it->second);
  }
  return Blob(std::move(sub));
}

Blob Blob::Without(std::string_view prefix) const {
  Fields rest;
  for (const auto& [name, array] : fields_) {
    if (!name.starts_with(prefix)) rest.emplace(name, array);
  }
  return Blob(std::move(rest));
}

std::size_t Blob::ByteCount() const {
  std::size_t bytes = 0;
  for (const auto& [name, array] : fields_) bytes += array.bytes().size();
  return bytes;
}

Hash Blob::ContentHash() const {
  Hasher hasher;
  for (const auto& [name, array] : fields_) {
    AddArrayHead(hasher, name, array.type(), array.item_bytes(), array.shape());
    hasher.Add(array.bytes());
  }
  return hasher.Finish();
}

void AddArrayHead(Hasher& hasher, std::string_view name, DType type, std::size_t item_bytes,
                  const Shape& shape) {
  hasher.Add(name);
  hasher.Add(static_cast<std::uint64_t>(type));
  hasher.Add(static_cast<std::uint64_t>(item_bytes));
  hasher.Add(static_cast<std::uint64_t>(shape.size()));
  for (const std::int64_t n : shape) hasher.Add(static_cast<std::uint64_t>(n));
}

}  // namespace cairn
