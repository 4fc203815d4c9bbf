// SPDX-License-Identifier: Apache-2.0
// The parameters of an effect or a post, and where each lies in the record that its programs read.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/driver/program.h"
#include "compiler/graph/graph.h"
#include "compiler/lower/image_slots.h"
#include "compiler/support/source.h"

namespace isoshade::driver {

/// An image that a program reads by way of a texture's record.
struct Image {
  lower::ImageSlot slot;  ///< its `place` is where the path is written
  std::string file;  ///< to open it; empty if no document gives a path
};

/// The record consists of the fields, one word for each image and one word for each count of taps, in this order.
struct ParameterBlock {
  std::vector<Field> fields;  ///< with their defaults
  std::vector<Image> images;  ///< the word is the number of the texture's record, or -1
  std::vector<Field> taps;    ///< of each node that sums taps; the default is the count, which is fixed

  /// The field with this name.
  std::optional<size_t> find(std::string_view name) const;
  /// The first word of a field in the record.
  size_t word_of(size_t field) const;
  size_t word_of_image(size_t image) const { return word_of(fields.size()) + image; }
  size_t word_of_taps(size_t node) const { return word_of_image(images.size()) + node; }
  size_t word_count() const { return word_of_taps(taps.size()); }
  /// The record of an object or post that gives no values: no image has a texture.
  std::vector<float> defaults() const;
  /// Whether the field that switches a pass or post on, if there is one, is 0 in this record.
  bool is_off(std::optional<size_t> enabled, std::span<const float> record) const {
    return enabled && record[word_of(*enabled)] == 0;
  }
  /// Whether there is such a field, and it is not 0 in this record.
  bool is_on(std::optional<size_t> field, std::span<const float> record) const {
    return field && record[word_of(*field)] != 0;
  }
  /// Whether the field that is the cutoff of a pass, if there is one, is above 0 in this record.
  bool cuts_out(std::optional<size_t> cutoff, std::span<const float> record) const {
    return !cutoff || record[word_of(*cutoff)] > 0;
  }
  /// How often a pass is drawn with this record, and how often at most with any.
  int repetitions(const interface::Repeat& repeat, std::span<const float> record) const {
    return repeat.parameter ? static_cast<int>(record[word_of(*repeat.parameter)]) : repeat.count;
  }
  int most_repetitions(const interface::Repeat& repeat) const {
    return repeat.parameter ? static_cast<int>(*fields[*repeat.parameter].max) : repeat.count;
  }
};

/// The type of a field of a parameter block.
graph::Type type_of(const Field& field);

/// A part of a record that one parameter or image has.
struct BlockItem {
  std::string_view name;  ///< in the block
  size_t first, words;
  bool is_switch;  ///< a boolean, an integer, or whether there is an image
};

/// Of the fields, then of the images.
std::vector<BlockItem> items_of(const ParameterBlock& block);

}  // namespace isoshade::driver
