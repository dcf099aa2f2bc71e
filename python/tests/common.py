"""What tests share."""

NAMES = ("Oscillator", "Pendulum", "Duffing")
IDS = {"Oscillator": "libration/Oscillator-v0", "Pendulum": "libration/PendulumSwingUp-v0", "Duffing": "libration/Duffing-v0"}
AUTORESETS = ("NextStep", "SameStep", "Disabled")

# All that an environment can suffer from; dt is that of none of them.
PERTURBED = dict(
    dt=0.02,
    substeps=4,
    action_delay=(0.01, 0.03),
    observation_delay=0.015,
    jitter=("uniform", 0.1),
    skew=0.01,
    observation_noise=0.02,
)


class Lent:
    """Numbers that are to be had by DLPack alone, as those of learners are."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **given):
        return self.array.__dlpack__(**given)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()
