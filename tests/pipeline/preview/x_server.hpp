// An X server of a test's own, without a screen, and a client that presses keys and looks at windows.
#pragma once

#include <sys/types.h>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace hotblade::pipeline::testing {

// RGB rows from the top.
struct Screenshot {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;

  [[nodiscard]] std::array<int, 3> at(int x, int y) const {
    const auto i =
        3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

// Xvfb on a display that was free, ended with the object. `started()` is false where there is no Xvfb.
class XServer {
 public:
  explicit XServer(const std::vector<std::string>& arguments = {});
  ~XServer();
  XServer(const XServer&) = delete;
  XServer& operator=(const XServer&) = delete;

  [[nodiscard]] bool started() const { return process_ > 0; }
  [[nodiscard]] const std::string& display() const { return display_; }  // ":7"

 private:
  pid_t process_ = -1;
  std::string display_;
};

// The first window on a display; waits for it up to a minute and throws std::runtime_error then.
class XWindow {
 public:
  explicit XWindow(const std::string& display);
  ~XWindow();
  XWindow(const XWindow&) = delete;
  XWindow& operator=(const XWindow&) = delete;

  void press(const std::string& key) const;  // by its X11 name
  void click(int x, int y) const;            // from the upper left
  void drag(int x0, int y0, int x1, int y1) const;
  [[nodiscard]] Screenshot look() const;
  // Looks until `seen` is true, up to a minute; returns whether it was, with the last look in `last`.
  [[nodiscard]] bool wait(const std::function<bool(const Screenshot&)>& seen, Screenshot& last) const;

 private:
  struct Connection;
  std::unique_ptr<Connection> x_;
};

}  // namespace hotblade::pipeline::testing
