// A time law without jumps of acceleration: the law that begins with even accelerations of the path parameter
// between samples, averaged over a window of time.
//
// The mean of the path parameter over the window stays on the path, grows where it did, starts and ends at
// rest without acceleration, and its rates are no faster than the fastest in the window. Its third derivative
// is the change of acceleration over the window by the window: no more than 2 a / T.
#pragma once

#include <vector>

namespace hotblade::pipeline {

class SmoothLaw {
 public:
  // From the path parameters of samples, ascending from 0, and the squared rates there: 0 at both ends, all
  // others above 0.
  SmoothLaw(std::vector<double> place, const std::vector<double>& rate2, double window_s);

  // The window's length longer than without it.
  [[nodiscard]] double duration_s() const { return time_.back() + window_s_; }
  // Returns the path parameter and its rate at a time from 0 to the duration.
  [[nodiscard]] double place(double t) const;
  [[nodiscard]] double rate(double t) const;
  // Returns when the path parameter is reached, to 1e-9 s.
  [[nodiscard]] double time_of(double place) const;

 private:
  // Of the law without the window: its place and the integral of that.
  struct Abrupt {
    double area = 0, place = 0;
  };
  [[nodiscard]] Abrupt abrupt(double t) const;

  double window_s_;
  std::vector<double> place_, rate_, time_, area_;
};

}  // namespace hotblade::pipeline
