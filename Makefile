# The front door. 'make help' lists what there is.
BUILD := build
JOBS ?= $(shell nproc)
# INSTALL=no leaves the system's packages alone.
INSTALL ?= yes
DATA ?=
OUT ?= out/demo
BASE ?=

install = @if [ "$(INSTALL)" != no ]; then scripts/install_dependencies.sh $(1); fi

.PHONY: help build demo demo-simulated test bench format lint clean

help:
	@echo "MLO: multi-object lidar odometry"
	@echo
	@echo "  make build             build the program: $(BUILD)/bin/mlo"
	@echo "  make demo              simulate a drive, run on it, evaluate; results in $(OUT)"
	@echo "  make demo DATA=FOLDER  run on a folder of scans instead (KITTI layouts, .bin, .pcd, .ply)"
	@echo "  make test              build and run all tests"
	@echo "  make bench             build and run the benchmarks; DATA=FOLDER (docs/results.md) adds KITTI's sequences"
	@echo "  make format            format the C++ sources"
	@echo "  make lint              check format and code; BASE=main only what differs from main"
	@echo "  make clean             remove what was built"
	@echo
	@echo "Missing Debian packages are installed first (INSTALL=no: not). JOBS=N limits parallel compiling."

build:
	$(call install,build)
	@cmake --preset release
	@cmake --build $(BUILD) --target mlo -j $(JOBS)

# Without DATA a drive is simulated first: everything that the demo needs comes with the project.
demo: build
	@if [ -n "$(DATA)" ]; then $(BUILD)/bin/mlo run "$(DATA)" --out "$(OUT)"; else $(MAKE) --no-print-directory demo-simulated; fi

demo-simulated:
	@echo "Simulating a drive through a city (synthetic data):"
	@$(BUILD)/bin/mlo simulate --scene city --length 150 --seed 7 --overwrite --out "$(OUT)/drive"
	@echo "Estimating trajectory, objects (found by the network that comes with mlo) and static map:"
	@$(BUILD)/bin/mlo run "$(OUT)/drive" --detector 3dssd --out "$(OUT)/run"
	@$(BUILD)/bin/mlo eval trajectory --truth "$(OUT)/drive/truth/poses_stamp.txt" --estimate "$(OUT)/run/trajectory.txt" \
	  --plot "$(OUT)/trajectory.svg"
	@echo
	@echo "Look at: $(OUT)/trajectory.svg (path and errors), $(OUT)/run/static_map.ply (map), $(OUT)/run/objects.csv (objects), $(OUT)/run/run.json (report)"

test:
	$(call install,build)
	@cmake --preset release
	@cmake --build $(BUILD) -j $(JOBS)
	@ctest --test-dir $(BUILD) --output-on-failure

bench: BOXES = $(DATA)/kitti_tracking/training/detections
bench:
	$(call install,build bench)
	@cmake --preset release -DMLO_BUILD_BENCHMARKS=ON
	@cmake --build $(BUILD) --target benchmarks -j $(JOBS)
	@for program in $(BUILD)/bin/bench_*; do $$program || exit 1; done
	@if [ -n "$(DATA)" ]; then \
	  cmake --build $(BUILD) --target mlo -j $(JOBS) && \
	  scripts/evaluate_sequences.py --data "$(DATA)" --program $(BUILD)/bin/mlo --out out/bench --variant default: && \
	  scripts/evaluate_sequences.py --data "$(DATA)" --program $(BUILD)/bin/mlo --out out/bench_objects --sequence 0005 \
	    --variant "PointRCNN: --detections $(BOXES)/pointrcnn_car/0000.txt $(BOXES)/pointrcnn_pedestrian/0000.txt \
	      $(BOXES)/pointrcnn_cyclist/0000.txt" \
	    --variant "cluster: --set detection.detector=cluster" --variant "3dssd: --set detection.detector=3dssd"; \
	fi

format:
	$(call install,develop)
	@git ls-files -- '*.cpp' '*.hpp' | xargs clang-format -i

lint:
	$(call install,build bench develop)
	@cmake --preset dev
	@scripts/lint.sh build-dev $(BASE)

clean:
	rm -rf build build-*
