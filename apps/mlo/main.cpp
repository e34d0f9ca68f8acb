#include <spdlog/spdlog.h>

#include <exception>

#include "apps/mlo/commands.hpp"
#include "mlo/core/error.hpp"

// Exit codes: 0 done; 1 the input or configuration cannot be used; 2 wrong usage; 3 a bug in mlo.
int main(int argc, char** argv) {
  CLI::App program{"MLO: multi-object lidar odometry. From the scans of one spinning lidar to trajectories, tracks and maps."};
  program.require_subcommand(1);
  program.set_version_flag("--version", MLO_VERSION);
  program.failure_message(CLI::FailureMessage::help);
#ifdef MLO_WITH_SIMULATOR
  mlo::apps::add_simulate(program);
#endif
  try {
    program.parse(argc, argv);
  } catch (const CLI::CallForHelp& e) {
    return program.exit(e);
  } catch (const CLI::CallForVersion& e) {
    return program.exit(e);
  } catch (const CLI::RuntimeError& e) {
    return e.get_exit_code();
  } catch (const CLI::ParseError& e) {
    program.exit(e);
    return 2;
  } catch (const mlo::InputError& e) {
    spdlog::error("{}", e.what());
    return 1;
  } catch (const std::exception& e) {
    spdlog::critical("internal error: {}", e.what());
    return 3;
  }
  return 0;
}
