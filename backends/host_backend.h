// SPDX-License-Identifier: Apache-2.0
// A backend whose images lie in arrays of the host, apart from what it draws with: it draws windows and runs full-screen
// passes one after the other.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "backends/shared.h"

namespace isoshade::backends {

/// Draws a view window by window. What all windows share is prepared once.
class ViewRenderer {
 public:
  virtual ~ViewRenderer() = default;
  /// Backend::draw() with one sample a pixel and without posts; `image` gets the size of the window.
  virtual bool draw(const Window& window, std::span<const int32_t> triangles, Image& image,
                    support::Diagnostics& diagnostics) = 0;
};

class HostBackend : public Backend {
 public:
  using Backend::Backend;

  bool reserve(size_t floats, support::Diagnostics& diagnostics) override;
  void write(size_t first, std::span<const float> floats) override;
  std::span<const float> read(const Slot& slot) override;
  bool is_finite() override { return is_finite_; }
  bool draw(const Drawing& drawing, support::Diagnostics& diagnostics) override;
  bool post(std::span<const ScreenPass> passes, const Slot& made, support::Diagnostics& diagnostics) override;

 protected:
  /// What `pass` and its arrays refer to and `vertices` outlive the ViewRenderer, and no other method is called until it is
  /// destroyed. Null after an error, which is reported.
  virtual std::unique_ptr<ViewRenderer> begin(const ViewPass& pass, const Layers& layers,
                                              std::span<const float> vertices,
                                              support::Diagnostics& diagnostics) = 0;
  /// Makes rows of an image: `rgba` receives 4 floats a pixel.
  virtual bool screen(const ScreenPass& pass, const Layers& layers, int first_row, int rows,
                      std::vector<float>& rgba, support::Diagnostics& diagnostics) = 0;

  support::Array<float> layers_;

 private:
  bool process(const ScreenPass& pass, int first_row, Image& samples, support::Diagnostics& diagnostics);
  void store(const Image& image, const Drawing& drawing, int first_row);

  bool is_finite_ = true;
};

}  // namespace isoshade::backends
