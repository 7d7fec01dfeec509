// SPDX-License-Identifier: Apache-2.0
// The place of each name in a list that somebody else keeps: a flat hash table with linear probing, since lists of
// materials may hold a million names.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

namespace clray::text {

class NameIndex {
 public:
  static constexpr std::uint32_t kNone = ~0u;

  /// The place of `name`, or kNone. `name_at(place)` gives the name at a place of the list.
  template <class NameAt>
  std::uint32_t find(std::string_view name, const NameAt& name_at) const {
    return entries_.empty() ? kNone : entries_[slot(hash_of(name), name, name_at)].place;
  }

  /// Makes room for so many names in all.
  void reserve(std::size_t names) {
    std::size_t size = 16;
    while (size < 2 * names) size *= 2;
    if (size > entries_.size()) resize(size);
  }

  /// Enters `name` at `place` unless it is there. Returns its place, and whether it is new.
  template <class NameAt>
  std::pair<std::uint32_t, bool> insert(std::string_view name, std::uint32_t place, const NameAt& name_at) {
    reserve(count_ + 1);
    const std::uint32_t hash = hash_of(name);
    Entry& entry = entries_[slot(hash, name, name_at)];
    if (entry.place != kNone) return {entry.place, false};
    entry = {hash, place};
    ++count_;
    return {place, true};
  }

 private:
  struct Entry {
    std::uint32_t hash = 0;
    std::uint32_t place = kNone;
  };

  static std::uint32_t hash_of(std::string_view name) {
    return static_cast<std::uint32_t>(std::hash<std::string_view>()(name));
  }

  template <class NameAt>
  std::size_t slot(std::uint32_t hash, std::string_view name, const NameAt& name_at) const {
    std::size_t i = hash & (entries_.size() - 1);
    while (entries_[i].place != kNone && !(entries_[i].hash == hash && name_at(entries_[i].place) == name))
      i = (i + 1) & (entries_.size() - 1);
    return i;
  }

  void resize(std::size_t size) {
    std::vector<Entry> before(size);
    before.swap(entries_);
    for (const Entry& entry : before) {
      if (entry.place == kNone) continue;
      std::size_t i = entry.hash & (entries_.size() - 1);
      while (entries_[i].place != kNone) i = (i + 1) & (entries_.size() - 1);
      entries_[i] = entry;
    }
  }

  std::vector<Entry> entries_;  // their number is a power of two, or zero
  std::size_t count_ = 0;
};

}  // namespace clray::text
