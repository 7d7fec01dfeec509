// SPDX-License-Identifier: Apache-2.0
// The command line's options, their help texts and their checks; see arguments.hpp.
#include "arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <type_traits>

#include "clray/error.hpp"
#include "clray/keys.hpp"
#include "text/near_miss.hpp"

namespace clray::cli {

namespace {

constexpr const char* kDescription =
    "clray traces light on space objects and says what comes back, each number with its error.\n"
    "SCENE is a mesh (.obj .ply .stl .off) or a scene file (.toml). A bare mesh is seen from +z\n"
    "by a laser station of 532 nm; directions X,Y,Z point away from the body, in its own frame.";

constexpr const char* kFooter =
    "\nOther uses:\n"
    "  clray merge DIR DIR ... --out DIR    the result of a run from the sums of all its shares\n"
    "  clray verify DIR                     computes a tenth of a run's sums again and compares their bits\n"
    "\nExamples:\n"
    "  clray satellite.obj                                   the pulse that a laser pulse becomes, to 1 %\n"
    "  clray --observer 1,0,1 --target-error 0.1% box.obj    seen from the side, to 0.1 %\n"
    "  clray --detector rgb --out picture satellite.obj      a picture\n"
    "  clray --check scene.toml                              is the scene file right?\n"
    "Exit status: 0 done, 1 a fault of clray, 2 wrong arguments, 3 unusable scene or mesh, 4 no usable\n"
    "device, 5 the result cannot be written, 128 + signal interrupted (what was finished is saved).";

/// The options' texts, before they are parsed as values.
struct Texts {
  std::optional<std::string> rays, target, time, source, observer, bins, bounces, seed, unit, group, slice, sampler,
      format, method, walk, checkpoint, share, memory;
};

/// "; did you mean --x?" for an option that comes near, else nothing.
std::string suggestion(const CLI::App& app, const std::string& word) {
  std::vector<std::string> known;
  for (const auto* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) known.push_back("--" + name);
  }
  const std::string near = text::nearest(word.substr(0, word.find('=')), known);
  return near.empty() ? "" : "; did you mean " + near + "?";
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// What --list knows, for messages.
std::string lists() {
  return "devices, " + joined(table_names());
}

/// Help in lines of at most 66 characters; CLI11 indents what follows a line break.
std::string wrapped(const std::string& text) {
  constexpr std::size_t kWidth = 66;
  std::string lines;
  std::size_t column = 0;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::size_t length = end - begin;
    if (column > 0) {
      const bool fits = column + 1 + length <= kWidth;
      lines += fits ? ' ' : '\n';
      column = fits ? column + 1 : 0;
    }
    lines.append(text, begin, length);
    column += length;
    begin = end + 1;
  }
  return lines;
}

/// Help of an option that sets a key: what the key's table says, then `more`.
std::string key_help(const std::string& of, const std::string& name, const std::string& more = {}) {
  for (const KeyInfo& key : scene_keys(of)) {
    if (key.name != name) continue;
    const std::string fallback = key.fallback == "none" || !more.empty() ? "" : " [" + key.fallback + "]";
    return key.meaning + ": " + key.values + (more.empty() ? "" : "; " + more) + fallback;
  }
  throw Error(ErrorCode::bug, "there is no key '" + name + "' in '" + of + "'");
}

/// An option with one value, kept as text; `value` is a string or an optional one.
template <class Text>
void text_option(CLI::App& app, const std::string& name, Text& value, const std::string& value_name,
                 const std::string& help, const std::string& group) {
  const auto keep = [&value, name](const std::string& text) {
    if (text.empty()) throw Error(ErrorCode::usage, "'': expected a value, or the option left out", name);
    value = text;
  };
  app.add_option_function<std::string>(name, keep, wrapped(help))->type_name(value_name)->group(group)->expected(1);
}

void add_options(CLI::App& app, Arguments& a, Texts& t) {
  const std::string scene = "Scene", run = "Run", output = "Output", save = "Saved sums", ask = "Questions",
                    test = "For tests of identity";
  if (a.verb.empty()) {
    app.add_option("SCENE", a.scene, "mesh (.obj .ply .stl .off) or scene file (.toml)")->type_name("");
  } else {
    app.add_option("RESULT", a.operands, "folders of results, or their files of sums")->type_name("");
  }
  app.add_option("--detector", a.scene_options.detectors,
                 wrapped("what is measured, may be repeated: " + joined(table_rows("detector")) +
                         "; replaces the scene file's list [delay for a mesh]"))
      ->type_name("KIND")
      ->group(scene)
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  text_option(app, "--source", t.source, "X,Y,Z", "direction toward the light [0,0,1 for a mesh]", scene);
  text_option(app, "--observer", t.observer, "X,Y,Z|source",
              "direction toward who looks, or 'source' for a station that sees its own laser [source for a mesh]",
              scene);
  text_option(app, "--material", a.scene_options.material, "TEXT",
              "one material for everything, such as \"lambert rho=0.3\" or \"ashikhmin-shirley rho=0.5 d=0.2 n=50\" "
              "(see --list brdf)",
              scene);
  text_option(app, "--length-unit", t.unit, "UNIT", "unit of mesh files: m, cm, mm, in, ft or a number of metres [m]",
              scene);
  text_option(app, "--bins", t.bins, "N", "bins " + key_help("delay", "bins"), scene);
  text_option(app, "--max-bounces", t.bounces, "N", key_help("trace", "max_bounces"), scene);

  text_option(app, "--device", a.device, "cpu|gpu|all|INDEX|NAME",
              "where to compute, by kind, number or part of the name [a GPU if there is one, else the CPU]", run);
  text_option(app, "--memory", t.memory, "SIZE",
              "memory that host and device may take, such as 800M or 4G; known before tracing [as much as there is]",
              run);
  text_option(app, "--method", t.method, "NAME", key_help("trace", "method"), run);
  text_option(app, "--rays", t.rays, "N", key_help("trace", "rays", "such as 65536, 1e6, 2^22, 4M"), run);
  text_option(app, "--target-error", t.target, "P%",
              key_help("trace", "target_error_percent", "in % [1%, with at least 2^22 rays in all]"), run);
  text_option(app, "--time-limit", t.time, "T", key_help("trace", "time_limit_s", "such as 30, 30s, 500ms, 5m, 2h"),
              run);
  text_option(app, "--seed", t.seed, "N", key_help("trace", "seed"), run);
  text_option(app, "--sampler", t.sampler, "NAME", key_help("trace", "sampler"), run);

  text_option(app, "--out", a.out, "DIR",
              "folder of the result; an older clray result there is replaced, nothing else is [clray-out/<scene>]",
              output);
  text_option(app, "--reference", a.reference, "FILE", "a summary.json or delay.csv to measure the true error against",
              output);
  text_option(
      app, "--format", t.format, "csv|netcdf",
      "netcdf: also NetCDF files with units and errors (CF) of pulses, spectra, light curves, pressure and cubes",
      output);
  app.add_flag("--no-plots", a.no_plots, wrapped("no plots (tables and pictures are still written)"))->group(output);
  app.add_flag("--quiet", a.quiet, wrapped("no progress and no closing table, only the device, the total and warnings"))
      ->group(output);
  app.add_flag("--explain", a.explain, wrapped("what was compiled in and what was left out for this scene, and why"))
      ->group(output);

  text_option(
      app, "--checkpoint", t.checkpoint, "T",
      "time between two files of sums, DIR.sums, from which --resume goes on; 0: none while the run goes on [30]",
      save);
  text_option(app, "--resume", a.resume, "DIR",
              "go on with the run whose sums are in DIR.sums; other options may be given, such as a sharper target",
              save);
  app.add_flag("--keep-sums", a.keep_sums, wrapped("keep DIR.sums when the run is complete"))->group(save);
  text_option(app, "--shard", t.share, "I/N", "trace share I of N of a run, into DIR.sums; clray merge adds the shares",
              save);

  app.add_option("--list", a.list, wrapped("print the devices, or a table of what scenes may say, and end: " + lists()))
      ->type_name("NAME")
      ->group(ask)
      ->expected(1);
  app.add_flag("--check", a.check, wrapped("check the scene, print what was understood, trace nothing"))->group(ask);
  app.add_flag("--dump-kernel", a.dump_kernel, wrapped("print the OpenCL program that would run for the scene"))
      ->group(ask);
  app.set_version_flag("--version", "clray " CLRAY_VERSION, "print the version and end")->group(ask);
  app.set_help_flag("-h,--help", "print this help and end")->group(ask);

  app.add_flag("--no-specialise", a.no_specialise, wrapped("run the generic program: same digest, slower"))
      ->group(test);
  app.add_flag("--force-bistatic", a.force_bistatic, wrapped("shadow rays even where the observer is at the source"))
      ->group(test);
  text_option(app, "--walk", t.walk, "NAME", key_help("trace", "walk"), test);
  text_option(app, "--work-group", t.group, "N", "work-items per work-group, 1 to 1024 [64]", test);
  text_option(app, "--slice-points", t.slice, "N", "points per replicate and launch [sized to time]", test);
}

std::uint64_t count_up_to(std::uint64_t most, const std::string& text, const std::string& option) {
  const std::uint64_t value = parse_count(text, option);
  if (value < 1 || value > most) {
    throw Error(ErrorCode::usage, "'" + text + "': expected a whole number of 1 to " + std::to_string(most), option);
  }
  return value;
}

/// A number or a word, as given in `text`, that a key takes.
template <class Value>
Value for_key(const std::string& name, const Value& value, const std::string& text, const std::string& option,
              const std::string& of = "trace") {
  std::string fault;
  if constexpr (std::is_arithmetic_v<Value>) {
    fault = key_fault(of, name, static_cast<double>(value));
  } else {
    fault = key_fault(of, name, value);
  }
  if (!fault.empty()) throw Error(ErrorCode::usage, "'" + text + "': " + fault, option);
  return value;
}

std::uint64_t count_for_key(const std::string& name, const std::string& text, const std::string& option,
                            const std::string& of = "trace") {
  return for_key(name, parse_count(text, option), text, option, of);
}

void parse_values(Arguments& a, const Texts& t) {
  if (t.rays) a.rays = count_for_key("rays", *t.rays, "--rays");
  if (t.target) {
    const double percent = parse_percent(*t.target, "--target-error");
    a.target_error_percent = for_key("target_error_percent", percent, *t.target, "--target-error");
  }
  if (t.time)
    a.time_limit_s = for_key("time_limit_s", parse_duration(*t.time, "--time-limit"), *t.time, "--time-limit");
  if (t.bins) a.scene_options.bins = static_cast<int>(count_for_key("bins", *t.bins, "--bins", "delay"));
  if (t.bounces) a.max_bounces = static_cast<int>(count_for_key("max_bounces", *t.bounces, "--max-bounces"));
  if (t.group) a.work_group = static_cast<int>(count_up_to(1024, *t.group, "--work-group"));
  if (t.slice) a.slice_points = count_up_to(std::numeric_limits<std::uint64_t>::max(), *t.slice, "--slice-points");
  if (t.memory) a.memory_bytes = parse_bytes(*t.memory, "--memory");
  if (t.checkpoint) a.checkpoint_s = parse_duration(*t.checkpoint, "--checkpoint");
  if (!(a.checkpoint_s >= 0.0))
    throw Error(ErrorCode::usage, "'" + *t.checkpoint + "': expected a time of 0 or more", "--checkpoint");
  if (t.share) a.share = parse_share(*t.share, "--shard");
  if (t.seed) a.seed = count_for_key("seed", *t.seed, "--seed");
  if (t.unit) a.scene_options.length_unit_m = parse_length_unit(*t.unit, "--length-unit");
  if (t.source) a.scene_options.source = parse_direction(*t.source, "--source");
  if (t.observer && *t.observer == "source") {
    a.scene_options.observer_at_source = true;
  } else if (t.observer) {
    a.scene_options.observer = parse_direction(*t.observer, "--observer");
  }
  if (t.format && *t.format != "csv" && *t.format != "netcdf")
    throw Error(ErrorCode::usage,
                "'" + *t.format + "': expected csv or netcdf" + text::did_you_mean(*t.format, {"csv", "netcdf"}),
                "--format");
  a.netcdf = t.format == "netcdf";
  if (t.method) {
    const std::string word = for_key("method", *t.method, *t.method, "--method");
    a.method = word == "exact"    ? Method::exact
               : word == "tiles"  ? Method::tiles
               : word == "points" ? Method::points
                                  : Method::automatic;
  }
  if (t.sampler) {
    const std::string word = for_key("sampler", *t.sampler, *t.sampler, "--sampler");
    a.sampler = word == "strata" ? SamplerKind::strata : word == "sobol" ? SamplerKind::sobol : SamplerKind::random;
  }
  if (t.walk) a.walk = for_key("walk", *t.walk, *t.walk, "--walk");
}

/// CLI11's complaint in our words.
[[noreturn]] void complain(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
    for (const auto& word : app.remaining()) {
      if (word.size() > 1 && word[0] == '-') {
        throw Error(ErrorCode::usage,
                    "there is no option " + word + suggestion(app, word) + " (clray --help lists all)");
      }
    }
    const auto extra = app.remaining();
    throw Error(ErrorCode::usage,
                "one scene at a time: '" + (extra.empty() ? "?" : extra.front()) + "' is one too many");
  }
  throw Error(ErrorCode::usage, std::string(error.what()) + " (clray --help explains the options)");
}

/// A command that stands where the scene should be.
void check_command_first(const Arguments& a) {
  if (!a.verb.empty() || (a.scene != "merge" && a.scene != "verify")) return;
  throw Error(ErrorCode::usage, "the command comes first: clray " + a.scene +
                                    (a.scene == "merge" ? " DIR DIR ..." : " DIR") + " [options]");
}

void check_whole(const Arguments& a) {
  if (!a.list.empty()) {
    const std::vector<std::string>& tables = table_names();
    if (a.list == "devices" || std::find(tables.begin(), tables.end(), a.list) != tables.end()) return;
    throw Error(ErrorCode::usage,
                "there is no list '" + a.list + "'; expected one of " + lists() + text::did_you_mean(a.list, tables),
                "--list");
  }
  if (!a.verb.empty() && a.operands.empty())
    throw Error(ErrorCode::usage, "nothing given to " + a.verb + ": name the " +
                                      (a.verb == "merge" ? "folders of results" : "folder of a result"));
  if (a.verb == "verify" && a.operands.size() > 1) throw Error(ErrorCode::usage, "one result at a time", "verify");
  if (a.verb == "merge" && a.out.empty()) throw Error(ErrorCode::usage, "expected --out DIR for the result", "merge");
  if (a.scene.empty() && a.resume.empty() && a.verb.empty()) {
    throw Error(ErrorCode::usage,
                "no scene given: name a mesh (.obj .ply .stl .off) or a scene file (.toml), or see clray --help");
  }
}

}  // namespace

void parse_words(std::vector<std::string> words, Arguments* arguments) {
  CLI::App app(kDescription, "clray");
  app.footer(kFooter);
  app.get_formatter()->column_width(34);
  Texts texts;
  add_options(app, *arguments, texts);
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    std::fputs(app.help().c_str(), stdout);
    arguments->finished = true;
    return;
  } catch (const CLI::CallForVersion&) {
    std::puts("clray " CLRAY_VERSION);
    arguments->finished = true;
    return;
  } catch (const CLI::ParseError& error) {
    check_command_first(*arguments);
    complain(app, error);
  }
  parse_values(*arguments, texts);
}

Arguments parse_arguments(int argc, char** argv) {
  Arguments arguments;
  for (int i = 0; i < argc; ++i) arguments.command += (i ? " " : "") + std::string(argv[i]);
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (!words.empty() && (words[0] == "merge" || words[0] == "verify")) {
    arguments.verb = words[0];
    words.erase(words.begin());
  }
  parse_words(words, &arguments);
  if (arguments.finished) return arguments;
  check_command_first(arguments);
  check_whole(arguments);
  if (!arguments.resume.empty() || !arguments.verb.empty()) {
    go_on(words, &arguments);
  } else {
    arguments.note = {std::filesystem::current_path().string()};
    arguments.note.insert(arguments.note.end(), words.begin(), words.end());
  }
  return arguments;
}

void apply(const Arguments& a, Scene& scene) {
  TraceOptions& trace = scene.trace;
  // A count or a target on the command line replaces those of the file.
  if (a.rays || a.target_error_percent) {
    trace.rays = a.rays.value_or(0);
    trace.target_error_percent = a.target_error_percent.value_or(0.0);
  }
  if (a.time_limit_s) trace.time_limit_s = *a.time_limit_s;
  if (a.max_bounces) trace.max_bounces = *a.max_bounces;
  if (a.method) trace.method = *a.method;
  if (a.seed) trace.seed = *a.seed;
  if (a.sampler) trace.sampler = *a.sampler;
  if (a.walk) trace.walk = *a.walk;
  if (a.no_specialise) trace.specialise = false;
  if (a.force_bistatic) trace.force_bistatic = true;
  if (a.work_group) trace.work_group_size = static_cast<std::uint32_t>(*a.work_group);
  if (a.slice_points) trace.slice_points = *a.slice_points;
}

}  // namespace clray::cli
