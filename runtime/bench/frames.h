// SPDX-License-Identifier: Apache-2.0
// `bench --frames`: how long each step of a frame takes, for the shipped scenes and for a mesh of 1 thousand to 1 million
// triangles, by size, threads and backend.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/bench/measure.h"

namespace isoshade::bench {

struct FrameBenchOptions {
  BenchOptions common;            ///< without rows, precisions and forms; `filter`: part of the names of scenes
  std::vector<int> sizes;         ///< sides of square frames; empty: 256 to 4096
  std::vector<int> threads;       ///< of the cpu backend; empty: 1, 2, 4, ... and all
};

/// A frame of which nothing is new: programs are compiled, memory has been used before. Seconds; medians.
struct FramePoint {
  std::string scene;    ///< "material_balls"; "mesh" where the number of triangles is varied
  int size = 0;         ///< its side
  std::string backend;  ///< "cpu", "vulkan"
  int threads = 0;      ///< of the host
  double triangles = 0; ///< of the scene
  /// `plan`: from the scene to the frame, without compiling documents. `whole` is the sum of all steps, in each frame.
  double plan = 0, vertices = 0, clip = 0, draw = 0, posts = 0, whole = 0;
  double spread = 0;  ///< of `whole`: the interquartile range
};

struct FrameReport {
  std::vector<std::string> machines;
  std::vector<FramePoint> points;
};

/// Frames of a scene are interleaved: each repetition draws one with every backend, number of threads and size. Returns
/// nothing, with diagnostics, if one cannot be drawn.
std::optional<FrameReport> measure_frames(const FrameBenchOptions& options, support::Diagnostics& diagnostics);

std::string csv_text(const FrameReport& report);
std::string json_text(const FrameReport& report);
/// The table that the command prints.
std::string summary(const FrameReport& report);
/// A gnuplot script that draws an SVG to the file `output`: steps by scene, and time by threads, triangles and size.
std::string gnuplot_text(const FrameReport& report, const std::string& output);

}  // namespace isoshade::bench
