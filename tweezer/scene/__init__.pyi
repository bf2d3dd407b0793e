from .description import FREE
from .files import SHIPPED, shipped_scenes
from .keys import by_key
from .load import SceneLike, checked_scene, load_scene
from .scene import Scene
from .settings import described_at, settable, value_at, with_settings

__all__ = [
    "FREE",
    "SHIPPED",
    "Scene",
    "SceneLike",
    "by_key",
    "checked_scene",
    "described_at",
    "load_scene",
    "settable",
    "shipped_scenes",
    "value_at",
    "with_settings",
]
