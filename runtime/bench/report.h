// SPDX-License-Identifier: Apache-2.0
// The bench's results as tables and as a picture.
#pragma once

#include <string>
#include <vector>

#include "runtime/bench/measure.h"

namespace isoshade::bench {

/// A line for each point, with a heading.
std::string csv_text(const Report& report);
std::string json_text(const Report& report);

/// The points that no other one beats in both time and error, fastest first.
std::vector<const Point*> pareto_front(const std::vector<const Point*>& points);

/// A program for gnuplot that draws an SVG to the file `output`: a panel for each effect, time against largest error,
/// of the cpu's fastest lanes and of vulkan. Precision is told by the shape of a mark, the backend by whether it is
/// filled, the form of the source by a letter; the line is the front.
std::string gnuplot_text(const Report& report, const std::string& output);

/// How a table of points reads on a terminal.
std::string summary(const Report& report);

}  // namespace isoshade::bench
