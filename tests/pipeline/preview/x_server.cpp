#include "tests/pipeline/preview/x_server.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <thread>

// After all others: its macros take names that they use.
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>

namespace hotblade::pipeline::testing {
namespace {

using namespace std::chrono_literals;
constexpr auto kPatience = 60s;  // of a machine under many times its load; a test that passes takes a second

void run_server(int to_parent, const std::vector<std::string>& arguments) {
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, 2);
  std::vector<std::string> words{"Xvfb",      "-displayfd", std::to_string(to_parent),
                                 "-screen",   "0",          "1400x900x24",
                                 "-nolisten", "tcp",        "-noreset"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execvp(argv[0], argv.data());
  ::_exit(127);
}

}  // namespace

XServer::XServer(const std::vector<std::string>& arguments) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  process_ = ::fork();
  if (process_ == 0) {
    ::close(ends[0]);
    run_server(ends[1], arguments);
  }
  ::close(ends[1]);
  // The server picks a free display and writes its number with a line end when it is ready.
  std::string number;
  char letter = 0;
  while (::read(ends[0], &letter, 1) == 1 && letter != '\n') number += letter;
  ::close(ends[0]);
  display_ = ":" + number;
  if (!number.empty()) return;
  ::waitpid(process_, nullptr, 0);
  process_ = -1;
}

XServer::~XServer() {
  if (process_ <= 0) return;
  ::kill(process_, SIGTERM);
  ::waitpid(process_, nullptr, 0);
}

struct XWindow::Connection {
  Display* display = nullptr;
  Window window = 0;

  ~Connection() {
    if (display) XCloseDisplay(display);
  }

  // The first child of the root that is shown.
  Window shown() const {
    Window root = 0, parent = 0, *children = nullptr, found = 0;
    unsigned int count = 0;
    if (!XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count)) return 0;
    for (unsigned int i = 0; i < count && !found; ++i) {
      XWindowAttributes attributes;
      const bool known = XGetWindowAttributes(display, children[i], &attributes) != 0;
      if (known && attributes.map_state == IsViewable && attributes.width > 16) found = children[i];
    }
    XFree(children);
    return found;
  }

  void send_button(int type, int x, int y) const {
    XEvent event{};
    event.xbutton.type = type;
    event.xbutton.display = display;
    event.xbutton.window = window;
    event.xbutton.root = DefaultRootWindow(display);
    event.xbutton.time = CurrentTime;
    event.xbutton.same_screen = True;
    event.xbutton.x = event.xbutton.x_root = x;
    event.xbutton.y = event.xbutton.y_root = y;
    event.xbutton.button = Button1;
    event.xbutton.state = type == ButtonRelease ? Button1Mask : 0;
    XSendEvent(display, window, True, type == ButtonPress ? ButtonPressMask : ButtonReleaseMask, &event);
    XFlush(display);
  }

  void send_motion(int x, int y) const {
    XEvent event{};
    event.xmotion.type = MotionNotify;
    event.xmotion.display = display;
    event.xmotion.window = window;
    event.xmotion.root = DefaultRootWindow(display);
    event.xmotion.same_screen = True;
    event.xmotion.x = event.xmotion.x_root = x;
    event.xmotion.y = event.xmotion.y_root = y;
    event.xmotion.state = Button1Mask;
    XSendEvent(display, window, True, PointerMotionMask | Button1MotionMask, &event);
    XFlush(display);
  }
};

XWindow::XWindow(const std::string& display) : x_(std::make_unique<Connection>()) {
  x_->display = XOpenDisplay(display.c_str());
  if (!x_->display) throw std::runtime_error("no X server at " + display);
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!(x_->window = x_->shown())) {
    if (std::chrono::steady_clock::now() > until) throw std::runtime_error("no window at " + display);
    std::this_thread::sleep_for(20ms);
  }
}

XWindow::~XWindow() = default;

void XWindow::press(const std::string& key) const {
  XEvent event{};
  event.xkey.type = KeyPress;
  event.xkey.display = x_->display;
  event.xkey.window = x_->window;
  event.xkey.root = DefaultRootWindow(x_->display);
  event.xkey.time = CurrentTime;
  event.xkey.same_screen = True;
  event.xkey.keycode = XKeysymToKeycode(x_->display, XStringToKeysym(key.c_str()));
  XSendEvent(x_->display, x_->window, True, KeyPressMask, &event);
  XFlush(x_->display);
}

void XWindow::click(int x, int y) const {
  x_->send_button(ButtonPress, x, y);
  x_->send_button(ButtonRelease, x, y);
}

void XWindow::drag(int x0, int y0, int x1, int y1) const {
  x_->send_button(ButtonPress, x0, y0);
  x_->send_motion((x0 + x1) / 2, (y0 + y1) / 2);
  x_->send_motion(x1, y1);
  x_->send_button(ButtonRelease, x1, y1);
}

Screenshot XWindow::look() const {
  XWindowAttributes attributes;
  XGetWindowAttributes(x_->display, x_->window, &attributes);
  Screenshot shot{attributes.width, attributes.height, {}};
  XImage* image = XGetImage(x_->display, x_->window, 0, 0, static_cast<unsigned>(shot.width),
                            static_cast<unsigned>(shot.height), AllPlanes, ZPixmap);
  if (!image) throw std::runtime_error("no image of the window");
  for (int y = 0; y < shot.height; ++y) {
    for (int x = 0; x < shot.width; ++x) {
      const unsigned long pixel = XGetPixel(image, x, y);
      for (const int shift : {16, 8, 0}) shot.rgb.push_back(static_cast<unsigned char>(pixel >> shift & 255));
    }
  }
  XDestroyImage(image);
  return shot;
}

bool XWindow::wait(const std::function<bool(const Screenshot&)>& seen, Screenshot& last) const {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  do {
    last = look();
    if (seen(last)) return true;
    std::this_thread::sleep_for(20ms);
  } while (std::chrono::steady_clock::now() < until);
  return false;
}

}  // namespace hotblade::pipeline::testing
