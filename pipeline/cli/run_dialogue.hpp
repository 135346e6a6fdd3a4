// What `hotblade run` asks the person at the machine, and what the answers mean.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pipeline/program/strip_jobs.hpp"
#include "robot/client/client.hpp"

namespace hotblade::pipeline {

// Reads a line from the terminal that was typed after the question was shown and ended with Enter; nothing
// when input ends before, or the run is interrupted.
[[nodiscard]] std::optional<std::string> ask(const std::string& question);

// Returns the question before a strip: blade, block, which side of it is up, how long it takes, what the
// controller is doing, and, where the strip is taken up half cut, how far it is and what will move first.
[[nodiscard]] std::string start_question(const Strip& strip, const robot::Job& job,
                                         const robot::protocol::Status& controller, bool resumes);

// Returns " [S003 S003R012, cut, 12.350 s]": the strip's rib that a waypoint belongs to, its phase and time.
[[nodiscard]] std::string place_of(const Strip& strip, std::optional<std::uint32_t> waypoint);

// What becomes of a strip that is held, or was left half cut with the blade in the foam.
enum class Recovery { kWithdraw, kRestart, kGiveUp };
// Returns what a typed word chooses: withdraw, restart, give up (or give-up); nothing else does.
[[nodiscard]] std::optional<Recovery> recovery_named(std::string_view word);

// Returns what is said of such a strip, and what each choice does.
[[nodiscard]] std::string recovery_text(const Strip& strip, const robot::Job& job,
                                        const robot::protocol::Status& controller);

// Returns the progress of a stream in words; a lost link first.
[[nodiscard]] std::string progress_text(const robot::Job& job, const robot::StreamProgress& progress);

}  // namespace hotblade::pipeline
