import sys,time
sys.path.insert(0,"/work/wt/map")
from pathlib import Path
from logical_robots_tui import Program, load_level
from logical_robots_tui.game.measuring import *
from logical_robots_tui.game.measuring import play_through, shift_start, patience_for
from logical_robots_tui.language.source_text import size_of
import os; os.nice(10)
# usage: run.py FILE PATIENCE seeds...   ("-1" = given start) ; stop at N losses/wins via env
level=load_level("10-distributed-mapping")
text=Path(sys.argv[1]).read_text(); pat=int(sys.argv[2])
seeds=[int(x) for a in sys.argv[3:] for x in (range(int(a.split("..")[0]),int(a.split("..")[1])+1) if ".." in a else [a])]
maxloss=int(os.environ.get("L",99)); maxwin=int(os.environ.get("W",99))
verbose=os.environ.get("V")
p=Program.compile(text); print(sys.argv[1].split("/")[-1],"size",size_of(text),flush=True)
wins=losses=0
for s in seeds:
    lv=level if s<0 else shift_start(level,s)
    home={}
    def over(frame,mind):
        for r in frame.after.robots:
            if (r.x-110)**2+(r.y-110)**2<6400:
                home.setdefault(r.name,frame.tick if hasattr(frame,'tick') else 0)
            else: home.pop(r.name,None)
        return False
    t=time.time(); r=play_through(lv,p,pat,is_over=over)
    w=r.won_at is not None; wins+=w; losses+=not w
    print(s,r.won_at,round(r.distance,1),f"{time.time()-t:.1f}s",home,flush=True)
    if losses>=maxloss or wins>=maxwin: break
print("wins",wins,"losses",losses)
