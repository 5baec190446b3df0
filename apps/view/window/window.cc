#include "apps/view/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <png.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "apps/view/window/panels.h"

namespace mjcf_pdg::app {
namespace {

// As in simulate: two clicks within so many seconds are a double-click.
constexpr double kDoubleClick = 0.25;
constexpr int kSamples = 4;  // of a pixel, against jagged edges

constexpr std::array<std::array<int, 2>, 15> kKeys = {{{GLFW_KEY_ESCAPE, kKeyEscape},
                                                       {GLFW_KEY_ENTER, kKeyEnter},
                                                       {GLFW_KEY_KP_ENTER, kKeyEnter},
                                                       {GLFW_KEY_TAB, kKeyTab},
                                                       {GLFW_KEY_BACKSPACE, kKeyBackspace},
                                                       {GLFW_KEY_RIGHT, kKeyRight},
                                                       {GLFW_KEY_LEFT, kKeyLeft},
                                                       {GLFW_KEY_DOWN, kKeyDown},
                                                       {GLFW_KEY_UP, kKeyUp},
                                                       {GLFW_KEY_PAGE_UP, kKeyPageUp},
                                                       {GLFW_KEY_F1, kKeyF1},
                                                       {GLFW_KEY_F5, kKeyF5},
                                                       {GLFW_KEY_F6, kKeyF6},
                                                       {GLFW_KEY_F7, kKeyF7},
                                                       {GLFW_KEY_SPACE, ' '}}};

std::string last_error;  // of GLFW

void KeepError(int, const char* words) { last_error = words ? words : ""; }

[[noreturn]] void Fail(const std::string& what) {
  throw Error("no window: " + what + (last_error.empty() ? "" : " (" + last_error + ")"));
}

KeyPress PressOf(int glfw_key, int mods) {
  KeyPress press{0, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0};
  for (const auto& [glfw, key] : kKeys) {
    if (glfw == glfw_key) press.key = key;
  }
  // GLFW names printing keys by the character that a US keyboard has there, so does simulate.
  if (press.key == 0 && glfw_key >= GLFW_KEY_APOSTROPHE && glfw_key <= GLFW_KEY_GRAVE_ACCENT) {
    press.key = glfw_key;
  }
  return press;
}

void WritePng(const std::string& path, int width, int height, std::vector<std::uint8_t>& rgb) {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = PNG_FORMAT_RGB;
  // OpenGL has the lowest line first.
  const std::string part = path + ".part";
  if (!png_image_write_to_file(&png, part.c_str(), 0, rgb.data(), -3 * width, nullptr) ||
      std::rename(part.c_str(), path.c_str()) != 0) {
    std::remove(part.c_str());
    throw Error("cannot write " + path + ": " + png.message);
  }
}

class Window {
 public:
  Window(Viewer& viewer, const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  void Run();

 private:
  static Window& Of(GLFWwindow* window) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
  }
  void Open(const WindowOptions& options, int samples);
  bool DrawnBySoftware() const;
  void Listen();
  void Key(int key, int mods);
  void Button(int button, int action, int mods);
  void Move(double x, double y);
  Held HeldButtons() const;
  std::array<double, 2> InPicture(double x, double y) const;
  mjrRect Picture() const;
  void Draw();
  void Serve();
  void ToggleFullScreen();
  void Screenshot(const std::string& path);

  Viewer& viewer_;
  GLFWwindow* window_ = nullptr;
  mjrContext context_;
  Panels panels_;
  float scale_ = 1.0f;
  bool in_picture_ = false;  // the button was pressed there
  double x_ = 0, y_ = 0;     // of the mouse
  double pressed_at_ = -1;
  int pressed_ = -1;
  std::array<int, 4> place_ = {};  // of the window before it filled the screen
  int width_ = 0, height_ = 0;     // of what is drawn [pixels]
};

Window::Window(Viewer& viewer, const WindowOptions& options) : viewer_(viewer) {
  mjr_defaultContext(&context_);
  glfwSetErrorCallback(KeepError);
#ifdef GLFW_PLATFORM  // since 3.4
  // Without this folder there is no Wayland, whose library would say so on stderr.
  if (!std::getenv("XDG_RUNTIME_DIR")) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  if (!glfwInit()) Fail("there is no display");
  Open(options, kSamples);
  const bool software = DrawnBySoftware();
  if (software) {  // where samples take three quarters of the time
    glfwDestroyWindow(window_);
    Open(options, 0);
  }
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window_, this);
  Listen();
  float vertical;
  glfwGetWindowContentScale(window_, &scale_, &vertical);
  mjr_makeContext(&viewer_.model(), &context_, 100 + 50 * (scale_ > 1.25f));
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // nothing is written where the program runs
  ImGui::GetIO().FontGlobalScale = scale_;
  ImGui::GetStyle().ScaleAllSizes(scale_);
  ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 1.0f;
  ImGui_ImplGlfw_InitForOpenGL(window_, true);  // goes on to call what Listen has set
  ImGui_ImplOpenGL3_Init("#version 120");       // compatibility profile, as mjr_* needs
  if (software) {                               // as simulate does
    viewer_.ghost_scene().scene.flags[mjRND_SHADOW] = 0;
    viewer_.ghost_scene().scene.flags[mjRND_REFLECTION] = 0;
  }
}

void Window::Open(const WindowOptions& options, int samples) {
  glfwWindowHint(GLFW_SAMPLES, samples);
  window_ =
      glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
  if (!window_) {
    glfwTerminate();
    Fail("the display gives no OpenGL");
  }
  glfwMakeContextCurrent(window_);
}

bool Window::DrawnBySoftware() const {
  using GetString = const unsigned char* (*)(unsigned);
  constexpr unsigned kRenderer = 0x1F01;  // GL_RENDERER
  const auto get = reinterpret_cast<GetString>(glfwGetProcAddress("glGetString"));
  const char* const renderer = get ? reinterpret_cast<const char*>(get(kRenderer)) : nullptr;
  return renderer && std::strstr(renderer, "llvmpipe");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  mjr_freeContext(&context_);
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::Listen() {
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int mods) {
    if (action != GLFW_RELEASE) Of(w).Key(key, mods);
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int mods) {
    Of(w).Button(button, action, mods);
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) { Of(w).Move(x, y); });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double clicks) {
    if (!ImGui::GetIO().WantCaptureMouse) Of(w).viewer_.Scroll(clicks);
  });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
    if (count > 0) Of(w).viewer_.Open(paths[0]);
  });
}

void Window::Key(int key, int mods) {
  if (!ImGui::GetIO().WantTextInput) viewer_.Press(PressOf(key, mods));
}

Held Window::HeldButtons() const {
  const auto down = [this](int button) {
    return glfwGetMouseButton(window_, button) == GLFW_PRESS;
  };
  const auto key = [this](int left, int right) {
    return glfwGetKey(window_, left) == GLFW_PRESS || glfwGetKey(window_, right) == GLFW_PRESS;
  };
  return {down(GLFW_MOUSE_BUTTON_LEFT), down(GLFW_MOUSE_BUTTON_RIGHT),
          down(GLFW_MOUSE_BUTTON_MIDDLE), key(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL),
          key(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT)};
}

// What the panels leave of the window.
mjrRect Window::Picture() const {
  const int side = static_cast<int>(kPanelWidth * scale_);
  const int left = viewer_.panels.left ? side : 0, right = viewer_.panels.right ? side : 0;
  return {left, 0, std::max(1, width_ - left - right), std::max(1, height_)};
}

std::array<double, 2> Window::InPicture(double x, double y) const {
  const mjrRect picture = Picture();
  return {(x - picture.left) / picture.height, 1 - y / picture.height};
}

void Window::Button(int button, int action, int mods) {
  if (action == GLFW_RELEASE) {
    in_picture_ = false;
    return viewer_.ReleaseButton();
  }
  if (ImGui::GetIO().WantCaptureMouse) return;
  in_picture_ = true;
  const double now = glfwGetTime();
  const bool doubled = button == pressed_ && now - pressed_at_ < kDoubleClick;
  pressed_ = doubled ? -1 : button;
  pressed_at_ = now;
  const Held held = {button == GLFW_MOUSE_BUTTON_LEFT, button == GLFW_MOUSE_BUTTON_RIGHT,
                     button == GLFW_MOUSE_BUTTON_MIDDLE, (mods & GLFW_MOD_CONTROL) != 0,
                     (mods & GLFW_MOD_SHIFT) != 0};
  const mjrRect picture = Picture();
  const auto [x, y] = InPicture(x_, y_);
  viewer_.PressButton(held, x, y, static_cast<double>(picture.width) / picture.height, doubled);
}

void Window::Move(double x, double y) {
  const int height = Picture().height;
  if (in_picture_) viewer_.MoveMouse(HeldButtons(), (x - x_) / height, (y_ - y) / height);
  x_ = x;
  y_ = y;
}

void Window::ToggleFullScreen() {
  if (glfwGetWindowMonitor(window_)) {
    glfwSetWindowMonitor(window_, nullptr, place_[0], place_[1], place_[2], place_[3], 0);
    return;
  }
  GLFWmonitor* const monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* const mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
  if (!mode) return;
  glfwGetWindowPos(window_, &place_[0], &place_[1]);
  glfwGetWindowSize(window_, &place_[2], &place_[3]);
  glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void Window::Screenshot(const std::string& path) {
  std::vector<std::uint8_t> rgb(std::size_t{3} * static_cast<std::size_t>(width_) * height_);
  mjr_readPixels(rgb.data(), nullptr, {0, 0, width_, height_}, &context_);
  WritePng(path, width_, height_, rgb);
}

// What the viewer asks of the world outside.
void Window::Serve() {
  if (const std::string text = viewer_.TakeClipboard(); !text.empty()) {
    glfwSetClipboardString(window_, text.c_str());
  }
  if (viewer_.TakePasteRequest()) {
    const char* const text = glfwGetClipboardString(window_);
    viewer_.Paste(text ? text : "");
  }
  if (viewer_.TakeFullScreen()) ToggleFullScreen();
}

void Window::Draw() {
  glfwGetFramebufferSize(window_, &width_, &height_);
  mjr_setBuffer(mjFB_WINDOW, &context_);
  mjr_rectangle({0, 0, width_, height_}, 0.2f, 0.2f, 0.2f, 1);
  mjr_render(Picture(), &viewer_.ghost_scene().scene, &context_);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  panels_.Draw(viewer_, scale_);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::Run() {
  while (!glfwWindowShouldClose(window_) && !viewer_.done()) {
    glfwPollEvents();
    viewer_.NextFrame();
    Serve();
    Draw();
    if (const std::string path = viewer_.TakeScreenshot(); !path.empty()) Screenshot(path);
    glfwSwapBuffers(window_);
  }
}

}  // namespace
}  // namespace mjcf_pdg::app

extern "C" void MjcfPdgShowWindow(mjcf_pdg::app::Viewer& viewer,
                                  const mjcf_pdg::app::WindowOptions& options) {
  mjcf_pdg::app::Window(viewer, options).Run();
}
