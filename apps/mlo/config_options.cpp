#include "apps/mlo/config_options.hpp"

namespace mlo::apps {

void add_config_options(CLI::App& command, ConfigArguments& arguments) {
  command
      .add_option("--preset", arguments.presets,
                  "Named settings, applied in order ('mlo config --list-presets'); several with commas")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option("--config", arguments.file, "Settings from a YAML file, applied after the presets")
      ->type_name("FILE");
  command.add_option("--set", arguments.settings, "One setting, applied last, as in sensor.max_range_m=80")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

}  // namespace mlo::apps
