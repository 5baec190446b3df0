// Ctrl-C and SIGTERM end long work between two rows, so that what is written is whole.
#ifndef MJCF_PDG_APPS_CONSOLE_INTERRUPT_H_
#define MJCF_PDG_APPS_CONSOLE_INTERRUPT_H_

#include <string>

namespace mjcf_pdg::app {

// From now on the first SIGINT or SIGTERM only asks to end; the second one ends the program.
void CatchInterrupts();

// The signal that asked to end; 0: none.
int Interrupted();

// Says on stderr "interrupted" and in `words` what stands of the work. Returns the exit code.
int SayInterrupted(const std::string& words);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CONSOLE_INTERRUPT_H_
