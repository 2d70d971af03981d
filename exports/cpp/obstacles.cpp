// Runs an exported obstacle model on one picture.
//
//   ./obstacles MODEL.onnx PICTURE.ppm UP_X UP_Y UP_Z OBSTACLES.pgm
//
// PICTURE is a binary PPM (P6) of the camera's size; UP is the world's up as a unit vector in the camera's
// optical frame (x right, y down, z forward). README.md says how to build this.

#include <onnxruntime_cxx_api.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

struct Picture {
  int64_t width = 0;
  int64_t height = 0;
  std::vector<uint8_t> rgb;
};

Picture read_ppm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  Picture picture;
  int largest = 0;
  if (!(file >> magic >> picture.width >> picture.height >> largest) || magic != "P6" || largest != 255)
    throw std::runtime_error(path + ": is no binary PPM with 8 bits a channel");
  file.get();  // the single white space before the pixels
  picture.rgb.resize(3 * picture.width * picture.height);
  file.read(reinterpret_cast<char*>(picture.rgb.data()), static_cast<std::streamsize>(picture.rgb.size()));
  if (!file) throw std::runtime_error(path + ": is cut off");
  return picture;
}

void write_pgm(const std::string& path, const uint8_t* mask, int64_t width, int64_t height) {
  std::ofstream file(path, std::ios::binary);
  file << "P5\n" << width << ' ' << height << "\n255\n";
  for (int64_t i = 0; i < width * height; ++i) file.put(static_cast<char>(mask[i] ? 255 : 0));
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

int main(int argc, char** argv) try {
  if (argc != 7) {
    std::fprintf(stderr, "usage: obstacles MODEL.onnx PICTURE.ppm UP_X UP_Y UP_Z OBSTACLES.pgm\n");
    return 2;
  }

  // 1. A session on one thread; waiting threads sleep.
  Ort::Env environment(ORT_LOGGING_LEVEL_WARNING, "obstacles");
  Ort::SessionOptions options;
  options.SetIntraOpNumThreads(1);
  options.AddConfigEntry("session.intra_op.allow_spinning", "0");
  Ort::Session session(environment, argv[1], options);

  // 2. The inputs, in place: RGB bytes as they come from the camera, and the up direction.
  Picture picture = read_ppm(argv[2]);
  std::array<float, 3> up_cam{std::strtof(argv[3], nullptr), std::strtof(argv[4], nullptr),
                              std::strtof(argv[5], nullptr)};
  const std::array<int64_t, 4> image_shape{1, picture.height, picture.width, 3};
  const std::array<int64_t, 1> up_shape{3};
  const Ort::MemoryInfo memory = Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault);
  std::array<Ort::Value, 2> inputs{
      Ort::Value::CreateTensor<uint8_t>(memory, picture.rgb.data(), picture.rgb.size(), image_shape.data(),
                                        image_shape.size()),
      Ort::Value::CreateTensor<float>(memory, up_cam.data(), up_cam.size(), up_shape.data(), up_shape.size())};

  // 3. Run, asking for the outputs that are needed by their names.
  const std::array<const char*, 2> input_names{"image", "up_cam"};
  const std::array<const char*, 2> output_names{"entropy", "obstacles"};
  const std::vector<Ort::Value> outputs = session.Run(Ort::RunOptions{}, input_names.data(), inputs.data(),
                                                      inputs.size(), output_names.data(), output_names.size());

  // 4. Use them: entropy is (h, w) float32 bits, obstacles (H, W) uint8.
  const auto mean = [](const auto* values, size_t count) {
    return std::accumulate(values, values + count, 0.0) / static_cast<double>(count);
  };
  const size_t entropies = outputs[0].GetTensorTypeAndShapeInfo().GetElementCount();
  const size_t pixels = outputs[1].GetTensorTypeAndShapeInfo().GetElementCount();
  const uint8_t* obstacles = outputs[1].GetTensorData<uint8_t>();
  std::printf("obstacle pixels %.1f %%\n", 100 * mean(obstacles, pixels));
  std::printf("mean entropy %.4f bits\n", mean(outputs[0].GetTensorData<float>(), entropies));
  write_pgm(argv[6], obstacles, picture.width, picture.height);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "obstacles: %s\n", error.what());
  return 1;
}
