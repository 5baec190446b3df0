#include "apps/egl_context.h"

#define EGL_NO_X11  // NOLINT(readability-identifier-naming): EGL's own switch.
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <stdexcept>
#include <string>

namespace mjcf_pdg::app {
namespace {

// First without any window system (Mesa), then whatever is there.
EGLDisplay InitializedDisplay() {
  const auto get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_platform_display != nullptr) {
    const EGLDisplay display =
        get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  }
  const EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  return EGL_NO_DISPLAY;
}

}  // namespace

EglContext::EglContext() {
  const char* const reason = Open();
  if (reason == nullptr) return;
  Close();
  throw std::runtime_error(std::string("cannot render: ") + reason);
}

EglContext::~EglContext() { Close(); }

const char* EglContext::Open() {
  display_ = InitializedDisplay();
  if (display_ == EGL_NO_DISPLAY) return "no EGL display (is a driver such as Mesa installed?)";
  if (!eglBindAPI(EGL_OPENGL_API)) return "this EGL has no desktop OpenGL";
  const EGLint attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                               EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint num_configs = 0;
  if (!eglChooseConfig(display_, attributes, &config, 1, &num_configs) || num_configs == 0) {
    return "EGL has no OpenGL configuration";
  }
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
  if (context_ == EGL_NO_CONTEXT) return "EGL cannot create an OpenGL context";
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    return "the OpenGL context needs a surface";
  }
  return nullptr;
}

void EglContext::Close() noexcept {
  if (display_ == EGL_NO_DISPLAY) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  eglTerminate(display_);
  eglReleaseThread();
}

void EglContext::SetBackground(const float rgb[3]) {
  using ClearColor = void (*)(float, float, float, float);
  const auto clear_color = reinterpret_cast<ClearColor>(eglGetProcAddress("glClearColor"));
  if (clear_color != nullptr) clear_color(rgb[0], rgb[1], rgb[2], 1);
}

}  // namespace mjcf_pdg::app
