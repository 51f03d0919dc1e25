import sys,os; os.nice(10)
sys.path.insert(0,"/work/wt/map")
from pathlib import Path
from logical_robots_tui import Program, load_level
from logical_robots_tui.game.measuring import play_through, shift_start
lv=load_level("10-distributed-mapping"); f,seed,a,b,step,who=sys.argv[1],*map(int,sys.argv[2:6]),sys.argv[6]
if seed>=0: lv=shift_start(lv,seed)
p=Program.compile(Path(f).read_text()); n=[0]
at={b.name:(b.x,b.y) for b in lv.beacons}
plain={b2.name:b1.name for b1,b2 in zip(load_level("10-distributed-mapping").beacons,lv.beacons)}
def over(frame,mind):
    n[0]+=1
    if n[0]>=a and (n[0]-a)%step==0:
        d={x.robot_name:x for x in frame.decisions} if hasattr(frame,"decisions") else {}
        m=d[who].memory
        r=next(r for r in frame.after.robots if r.name==who)
        bb=min(lv.beacons,key=lambda b:(b.x-r.x)**2+(b.y-r.y)**2)
        print(n[0],f"({r.x:.0f},{r.y:.0f},{r.angle*57.3:.0f}) L{r.left_engine:.2f} R{r.right_engine:.2f}",{k:(plain.get(v,v) if isinstance(v,str) else v) for k,v in m.items() if k not in("roads","places","report")}, {plain[p["label"]]:round(p["far"]) for p in (m["places"] or []) if (at[p["label"]][0]-r.x)**2+(at[p["label"]][1]-r.y)**2<120**2} if "places" in m else "",flush=True)
    return n[0]>=b
print(play_through(lv,p,b,is_over=over))
